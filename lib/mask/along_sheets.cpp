// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/along_sheets.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/pi.h"
#include "mask/coarse.h"
#include "mask/filters.h"

namespace trephine::mask {
namespace {

constexpr double min_edge_mm = 1.0;  ///< sigma of the gradients, at least
constexpr double edge_ratio =
    0.67;  ///< of the mean along the planes, for strong noise turns planes that are found from little
constexpr double tensor_ratio = 2.0;  ///< sigma of the mean of their products to that of the gradients
constexpr double block_mm = 2;        ///< the planes are found on this raster
constexpr double across_mm = 0.35;
constexpr int planes_count = 144;

using Tensor = std::array<grid::Grid<float>, 6>;  ///< xx, yy, zz, xy, xz, yz

/// Directions spread evenly over a hemisphere (a Fibonacci lattice).
std::vector<Vec3> directions() {
  std::vector<Vec3> d;
  for (int n = 0; n < planes_count; ++n) {
    const double z = (n + 0.5) / planes_count, r = std::sqrt(1 - z * z), angle = n * pi * (3 - std::sqrt(5.0));
    d.push_back({r * std::cos(angle), r * std::sin(angle), z});
  }
  return d;
}

struct Tap {
  int i, j, k;
  float weight;
};

std::vector<Tap> disc(const grid::Lattice& l, Vec3 normal, double sigma_mm) {
  const double reach = 2.2 * sigma_mm;
  int n[3];
  for (int a = 0; a < 3; ++a) n[a] = int(reach / l.spacing_mm[a]);
  std::vector<Tap> taps;
  for (int k = -n[2]; k <= n[2]; ++k)
    for (int j = -n[1]; j <= n[1]; ++j)
      for (int i = -n[0]; i <= n[0]; ++i) {
        const Vec3 p{i * l.spacing_mm.x, j * l.spacing_mm.y, k * l.spacing_mm.z};
        const double off = dot(p, normal), along2 = dot(p, p) - off * off;
        if (along2 > reach * reach) continue;
        const double w = std::exp(-off * off / (2 * across_mm * across_mm) - along2 / (2 * sigma_mm * sigma_mm));
        if (w > 0.02) taps.push_back({i, j, k, float(w)});
      }
  return taps;
}

/// The products of gradients, summed over blocks and then averaged.
Tensor structure_of(const grid::Grid<float>& smooth, const BitMask& known, const CoarseRaster& r, double tensor_mm,
                    const Progress& progress) {
  Tensor t;
  for (auto& g : t) g = grid::Grid<float>(r.cells);
  const grid::Lattice& l = smooth;
  parallel_for(0, r.cells.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (int bk = int(from); bk < to; ++bk)
      for (int k = bk * r.factor[2]; k < std::min(l.size[2], (bk + 1) * r.factor[2]); ++k)
        for (int j = 0; j < l.size[1]; ++j)
          for (int i = 0; i < l.size[0]; ++i) {
            if (!known.get(i, j, k)) continue;
            const int at[3] = {i, j, k};
            float g[3];
            for (int a = 0; a < 3; ++a) {
              int low[3] = {i, j, k}, high[3] = {i, j, k};
              if (at[a] > 0 && (--low[a], !known.get(low[0], low[1], low[2]))) ++low[a];
              if (at[a] + 1 < l.size[a] && (++high[a], !known.get(high[0], high[1], high[2]))) --high[a];
              const int steps = high[a] - low[a];
              g[a] = steps ? (smooth.at(high[0], high[1], high[2]) - smooth.at(low[0], low[1], low[2])) /
                                 float(steps * l.spacing_mm[a])
                           : 0.f;
            }
            const std::size_t b = r.cells.index(i / r.factor[0], j / r.factor[1], bk);
            t[0].voxels[b] += g[0] * g[0];
            t[1].voxels[b] += g[1] * g[1];
            t[2].voxels[b] += g[2] * g[2];
            t[3].voxels[b] += g[0] * g[1];
            t[4].voxels[b] += g[0] * g[2];
            t[5].voxels[b] += g[1] * g[2];
          }
  });
  for (auto& g : t) gaussian(g, tensor_mm, progress);
  return t;
}

/// For each block, the plane that is most nearly perpendicular to the tensor's principal direction.
grid::Grid<std::uint8_t> planes_of(const Tensor& t, const std::vector<Vec3>& normals, const Progress& progress) {
  grid::Grid<std::uint8_t> plane(t[0]);
  parallel_for(0, plane.size[2], 2, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (std::size_t v = plane.index(0, 0, int(from)); v < plane.index(0, 0, int(to)); ++v) {
      const double xx = t[0].voxels[v], yy = t[1].voxels[v], zz = t[2].voxels[v];
      const double xy = t[3].voxels[v], xz = t[4].voxels[v], yz = t[5].voxels[v];
      if (!(xx + yy + zz > 0)) continue;
      double best = -1;
      for (std::size_t n = 0; n < normals.size(); ++n) {
        const Vec3& d = normals[n];
        const double e =
            d.x * d.x * xx + d.y * d.y * yy + d.z * d.z * zz + 2 * (d.x * d.y * xy + d.x * d.z * xz + d.y * d.z * yz);
        if (e > best) best = e, plane.voxels[v] = std::uint8_t(n);
      }
    }
  });
  return plane;
}

}  // namespace

grid::Grid<float> averaged_along_sheets(const grid::Grid<float>& hu, const BitMask& known, double sigma_mm,
                                        const Progress& progress, const BitMask* where) {
  const grid::Lattice& l = hu;
  const std::vector<Vec3> normals = directions();
  std::vector<std::vector<Tap>> discs;
  for (const Vec3& n : normals) discs.push_back(disc(l, n, sigma_mm));
  const CoarseRaster blocks = coarse_raster(l, block_mm);
  const double edge_mm = std::max(min_edge_mm, edge_ratio * sigma_mm);
  const grid::Grid<std::uint8_t> plane = planes_of(structure_of(masked_gaussian(hu, known, edge_mm, 0, 0.02, progress),
                                                                known, blocks, tensor_ratio * edge_mm, progress),
                                                   normals, progress);
  grid::Grid<float> out = hu;
  parallel_for(0, l.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          if (!known.get(i, j, k) || (where && !where->get(i, j, k))) continue;
          const auto& taps = discs[plane.at(i / blocks.factor[0], j / blocks.factor[1], k / blocks.factor[2])];
          float sum = 0, weight = 0;
          for (const Tap& t : taps) {
            const int x = i + t.i, y = j + t.j, z = k + t.k;
            if (!known.at(x, y, z)) continue;
            sum += t.weight * hu.at(x, y, z);
            weight += t.weight;
          }
          out.at(i, j, k) = sum / weight;
        }
  });
  return out;
}

}  // namespace trephine::mask
