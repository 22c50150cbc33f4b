// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/total_variation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"

namespace trephine::mask {
namespace {

/// The row's part between its first and last voxel in the domain.
struct Span {
  int from, to;
};

}  // namespace

void total_variation(grid::Grid<float>& hu, const BitMask& domain, double strength_hu_mm, int iterations,
                     const Progress& progress) {
  if (!(strength_hu_mm > 0)) return;
  const grid::Lattice& l = hu;
  const int nx = l.size[0], ny = l.size[1], nz = l.size[2];
  const std::size_t dy = std::size_t(nx), dz = std::size_t(nx) * ny;
  // Differences in units of the first axis' spacing.
  const float ry = float(l.spacing_mm.x / l.spacing_mm.y), rz = float(l.spacing_mm.x / l.spacing_mm.z);
  const float radius = float(strength_hu_mm / l.spacing_mm.x);
  // `in` is 1 in the domain, with a row and a slice of 0 beyond the lattice's end.
  std::vector<float> in(l.count() + dz + dy + 1, 0.f);
  std::vector<Span> spans(std::size_t(ny) * nz);
  parallel_for(0, nz, 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < ny; ++j) {
        Span& s = spans[std::size_t(k) * ny + j];
        s = {nx, 0};
        for (int i = 0; i < nx; ++i)
          if (domain.get(i, j, k)) {
            in[l.index(i, j, k)] = 1;
            s.from = std::min(s.from, i);
            s.to = i + 1;
          }
      }
  });
  std::vector<float> u(in.size(), 0.f), ahead(in.size(), 0.f), px_store(in.size() + 1, 0.f), py(in.size(), 0.f),
      pz(in.size(), 0.f);
  float* const px = px_store.data() + 1;  // a voxel has an edge from before it, the first one too
  parallel_for(0, nz, 4, [&](std::int64_t from, std::int64_t to) {
    for (std::size_t v = l.index(0, 0, int(from)); v < l.index(0, 0, int(to)); ++v)
      u[v] = ahead[v] = in[v] > 0 ? hu.voxels[v] : 0.f;
  });
  float tau = 0.3f, sigma = 1 / (4 * (1 + ry * ry + rz * rz) * tau);
  struct Row {
    std::size_t v;
    int n;
    std::size_t before_y, after_y, before_z, after_z;  // the neighbours' rows, or the zeros beyond the end
  };
  const auto rows = [&](auto&& body) {
    parallel_for(0, nz, 2, [&](std::int64_t from, std::int64_t to) {
      for (int k = int(from); k < to; ++k)
        for (int j = 0; j < ny; ++j) {
          const Span s = spans[std::size_t(k) * ny + j];
          if (s.from >= s.to) continue;
          const std::size_t v = l.index(s.from, j, k), zeros = l.count();
          body(Row{v, s.to - s.from, j > 0 ? v - dy : zeros, j + 1 < ny ? v + dy : zeros, k > 0 ? v - dz : zeros,
                   k + 1 < nz ? v + dz : zeros});
        }
    });
  };
  for (int round = 0; round < iterations; ++round) {
    progress.check();
    rows([&](const Row& r) {
      const float *a = &ahead[r.v], *ay = &ahead[r.after_y], *az = &ahead[r.after_z];
      const float *m = &in[r.v], *my = &in[r.after_y], *mz = &in[r.after_z];
      float *x = px + r.v, *y = &py[r.v], *z = &pz[r.v];
      const auto step = [&](int i, float qx) {
        const float qy = y[i] + sigma * ry * m[i] * my[i] * (ay[i] - a[i]),
                    qz = z[i] + sigma * rz * m[i] * mz[i] * (az[i] - a[i]);
        const float scale = 1 / std::max(1.f, std::sqrt(qx * qx + qy * qy + qz * qz) / radius);
        x[i] = qx * scale;
        y[i] = qy * scale;
        z[i] = qz * scale;
      };
      for (int i = 0; i + 1 < r.n; ++i) step(i, x[i] + sigma * m[i] * m[i + 1] * (a[i + 1] - a[i]));
      step(r.n - 1, 0.f);
    });
    const float theta = 1 / std::sqrt(1 + 1.4f * tau), share = 1 / (1 + tau);
    rows([&](const Row& r) {
      const float *f = &hu.voxels[r.v], *m = &in[r.v], *x = px + r.v, *y = &py[r.v], *z = &pz[r.v];
      const float *yb = &py[r.before_y], *zb = &pz[r.before_z];
      float *now = &u[r.v], *next = &ahead[r.v];
      for (int i = 0; i < r.n; ++i) {
        const float flow = x[i] - x[i - 1] + ry * (y[i] - yb[i]) + rz * (z[i] - zb[i]);
        const float fresh = m[i] * (now[i] + tau * (flow + f[i])) * share;
        next[i] = fresh + theta * (fresh - now[i]);
        now[i] = fresh;
      }
    });
    tau *= theta;
    sigma /= theta;
  }
  for (std::size_t v = 0; v < l.count(); ++v)
    if (in[v] > 0) hu.voxels[v] = u[v];
}

}  // namespace trephine::mask
