// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "segmentation/filters.h"

namespace trephine::segmentation {
namespace {

struct Sweeper {
  const Lattice& l;
  std::vector<Vec3> points;           ///< on the surface, mm from voxel (0, 0, 0) along the axes
  std::vector<std::int32_t> closest;  ///< of each voxel, -1 unknown
  Grid<float> distance;

  double to_point(int i, int j, int k, std::int32_t p) const {
    return norm(points[p] - Vec3{i * l.spacing_mm.x, j * l.spacing_mm.y, k * l.spacing_mm.z});
  }
  void offer(std::size_t v, int i, int j, int k, std::int32_t p) {
    if (p < 0) return;
    const float d = float(to_point(i, j, k, p));
    if (d < distance.voxels[v]) {
      distance.voxels[v] = d;
      closest[v] = p;
    }
  }
  void from_neighbour(int i, int j, int k, int di, int dj, int dk) {
    if (l.contains(i + di, j + dj, k + dk)) offer(l.index(i, j, k), i, j, k, closest[l.index(i + di, j + dj, k + dk)]);
  }
  void sweep(int ks, const Progress& progress) {
    const int nx = l.size[0], ny = l.size[1], nz = l.size[2];
    for (int kk = 0; kk < nz; ++kk) {
      progress.check();
      const int k = ks > 0 ? kk : nz - 1 - kk;
      for (int js : {1, -1})
        for (int jj = 0; jj < ny; ++jj) {
          const int j = js > 0 ? jj : ny - 1 - jj;
          for (int i = 0; i < nx; ++i) {
            from_neighbour(i, j, k, 0, 0, -ks);
            from_neighbour(i, j, k, 0, -js, 0);
            from_neighbour(i, j, k, 0, -js, -ks);
            from_neighbour(i, j, k, -1, 0, 0);
            from_neighbour(i, j, k, -1, -js, 0);
          }
          for (int i = nx - 1; i >= 0; --i) {
            from_neighbour(i, j, k, 1, 0, 0);
            from_neighbour(i, j, k, 1, -js, 0);
          }
        }
    }
  }
};

}  // namespace

Grid<float> signed_distance_mm(const Field& field, const Progress& progress) {
  const Lattice& l = field;
  const Vec3 s = l.spacing_mm;
  Sweeper w{l, {}, std::vector<std::int32_t>(l.count(), -1), Grid<float>(l, 1e6f)};
  // Surface points: where the field crosses 0 along the edges of the lattice, and, nearer to the foot of the
  // perpendicular, one Newton step along the gradient from each voxel beside the surface.
  const auto value = [&](int i, int j, int k) {
    return double(
        field.at(std::clamp(i, 0, l.size[0] - 1), std::clamp(j, 0, l.size[1] - 1), std::clamp(k, 0, l.size[2] - 1)));
  };
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const double f = field.at(i, j, k);
        bool beside = false;
        const std::size_t v = l.index(i, j, k);
        for (int axis = 0; axis < 3; ++axis)
          for (int side : {-1, 1}) {
            const int n[3] = {i + (axis == 0) * side, j + (axis == 1) * side, k + (axis == 2) * side};
            if (!l.contains(n[0], n[1], n[2])) continue;
            const double g = field.at(n[0], n[1], n[2]);
            if ((f > 0) == (g > 0)) continue;
            beside = true;
            Vec3 p{i * s.x, j * s.y, k * s.z};
            p[axis] += side * s[axis] * std::min(1.0, f / (f - g));
            w.points.push_back(p);
            w.offer(v, i, j, k, std::int32_t(w.points.size() - 1));
          }
        if (!beside) continue;
        const Vec3 gradient{(value(i + 1, j, k) - value(i - 1, j, k)) / (2 * s.x),
                            (value(i, j + 1, k) - value(i, j - 1, k)) / (2 * s.y),
                            (value(i, j, k + 1) - value(i, j, k - 1)) / (2 * s.z)};
        const double g2 = dot(gradient, gradient);
        if (!(g2 > 0)) continue;
        const Vec3 step = gradient * (-f / g2);
        if (norm(step) > w.distance.voxels[v]) continue;
        w.points.push_back(Vec3{i * s.x, j * s.y, k * s.z} + step);
        w.offer(v, i, j, k, std::int32_t(w.points.size() - 1));
      }
  for (int round = 0; round < 2; ++round) {
    w.sweep(1, progress);
    w.sweep(-1, progress);
  }
  for (std::size_t v = 0; v < l.count(); ++v)
    if (!(field.voxels[v] > 0)) w.distance.voxels[v] = -w.distance.voxels[v];
  return std::move(w.distance);
}

}  // namespace trephine::segmentation
