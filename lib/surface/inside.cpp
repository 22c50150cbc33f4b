// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/inside.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/parallel.h"

namespace trephine::surface {
namespace {

// A triangle in continuous indices (x along j, y along k, z along i), with its corners in ascending order. So equal
// triangles and equal edges, of one mesh or of two, give equal answers whatever their direction.
using Corners = std::array<Vec3, 3>;

void sort_corners(Corners& c) {
  std::sort(c.begin(), c.end(), [](const Vec3& a, const Vec3& b) {
    return a.y != b.y ? a.y < b.y : a.x != b.x ? a.x < b.x : a.z < b.z;
  });
}

// Whether the half line from (px, py) towards larger x crosses the edge. The half-open rule decides where it meets an
// end.
bool edge_passes_right(const Vec3& low, const Vec3& high, double px, double py) {
  if (low.y > py || high.y <= py) return false;
  return low.x + (py - low.y) * ((high.x - low.x) / (high.y - low.y)) > px;
}

bool covers(const Corners& c, double px, double py) {
  return edge_passes_right(c[0], c[1], px, py) ^ edge_passes_right(c[1], c[2], px, py) ^
         edge_passes_right(c[0], c[2], px, py);
}

// Where the row through (px, py) meets the triangle's plane. The result is clamped to the triangle's extent, because
// the plane may be nearly parallel to the row.
double depth_at(const Corners& t, double px, double py) {
  const Vec3 &a = t[0], &b = t[1], &c = t[2];
  const Vec3 n = cross(b - a, c - a);
  const double lo = std::min(a.z, std::min(b.z, c.z)), hi = std::max(a.z, std::max(b.z, c.z));
  const double z = n.z != 0 ? a.z - (n.x * (px - a.x) + n.y * (py - a.y)) / n.z : (lo + hi) / 2;
  return std::isfinite(z) ? std::clamp(z, lo, hi) : (lo + hi) / 2;
}

int clamp_to(double v, int low, int high) { return v <= low ? low : v >= high ? high : int(v); }

}  // namespace

grid::Mask voxelize_inside(const TriMesh& mesh, const grid::Lattice& lattice, const Progress& progress) {
  check_mesh(mesh);
  std::vector<Vec3> points(mesh.points_mm.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 ijk = lattice.to_index(mesh.world_mm(i));
    points[i] = {ijk.y, ijk.z, ijk.x};
  }
  // Each crossing toggles the first voxel behind it; the running parity along a row is then inside or outside.
  grid::Mask mask(lattice);
  const int ni = lattice.size[0], nj = lattice.size[1], nk = lattice.size[2];
  std::vector<std::uint8_t> odd(std::size_t(nj) * std::size_t(nk));
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    if (n % 65536 == 0) progress.report(0.9 * double(n) / double(mesh.triangles.size()));
    const auto& v = mesh.triangles[n];
    Corners t{points[v[0]], points[v[1]], points[v[2]]};
    sort_corners(t);
    const auto [x0, x1] = std::minmax({t[0].x, t[1].x, t[2].x});
    const double y0 = t[0].y, y1 = t[2].y;
    const int j1 = clamp_to(std::floor(x1) + 2, 0, nj), k1 = clamp_to(std::floor(y1) + 2, 0, nk);
    for (int k = clamp_to(std::floor(y0) - 1, 0, nk); k < k1; ++k)
      for (int j = clamp_to(std::floor(x0) - 1, 0, nj); j < j1; ++j) {
        if (!covers(t, j, k)) continue;
        const int first = clamp_to(std::ceil(depth_at(t, j, k)), 0, ni);
        odd[std::size_t(k) * std::size_t(nj) + std::size_t(j)] ^= 1;
        if (first < ni) mask.at(first, j, k) ^= 1;
      }
  }
  const std::size_t open = std::size_t(std::count(odd.begin(), odd.end(), 1));
  if (open > 0)
    throw Error(ExitCode::bad_input, "", "surface",
                "not closed: " + std::to_string(open) + " rows of voxels enter it without leaving it");
  parallel_for(0, std::int64_t(odd.size()), 4096, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t row = from; row < to; ++row) {
      std::uint8_t* p = mask.voxels.data() + row * ni;
      for (int i = 1; i < ni; ++i) p[i] ^= p[i - 1];
    }
  });
  progress.report(1);
  return mask;
}

}  // namespace trephine::surface
