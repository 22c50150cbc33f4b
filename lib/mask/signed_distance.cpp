// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "mask/filters.h"

namespace trephine::mask {
namespace {

struct Sweeper {
  const grid::Lattice& l;
  std::vector<Vec3> points;           ///< on the surface, mm from voxel (0, 0, 0) along the axes
  std::vector<std::int32_t> closest;  ///< index for each voxel, -1 unknown
  grid::Grid<float> distance;

  void offer(std::size_t v, Vec3 voxel_mm, std::int32_t p) {
    const Vec3 way = points[std::size_t(p)] - voxel_mm;
    // Most points are further: told by the square, with room for what floats round.
    const double is = distance.voxels[v], squared = dot(way, way);
    if (squared > 1.000001 * is * is) return;
    const float d = float(norm(way));
    if (d < distance.voxels[v]) {
      distance.voxels[v] = d;
      closest[v] = p;
    }
  }
  void from_neighbour(std::size_t v, std::ptrdiff_t offset, Vec3 voxel_mm) {
    const std::int32_t p = closest[std::size_t(std::ptrdiff_t(v) + offset)];
    if (p >= 0 && p != closest[v]) offer(v, voxel_mm, p);
  }
  void sweep(int ks, const Progress& progress) {
    const int nx = l.size[0], ny = l.size[1], nz = l.size[2];
    const Vec3 s = l.spacing_mm;
    const std::ptrdiff_t slice = -ks * std::ptrdiff_t(nx) * ny;
    for (int kk = 0; kk < nz; ++kk) {
      progress.check();
      const int k = ks > 0 ? kk : nz - 1 - kk;
      const bool below = kk > 0;
      for (int js : {1, -1})
        for (int jj = 0; jj < ny; ++jj) {
          const int j = js > 0 ? jj : ny - 1 - jj;
          const bool before = jj > 0;
          const std::ptrdiff_t row = -js * std::ptrdiff_t(nx);
          const std::size_t first = l.index(0, j, k);
          const auto at = [&](int i) { return Vec3{i * s.x, j * s.y, k * s.z}; };
          for (int i = 0; i < nx; ++i) {
            const std::size_t v = first + std::size_t(i);
            if (below) from_neighbour(v, slice, at(i));
            if (before) from_neighbour(v, row, at(i));
            if (before && below) from_neighbour(v, row + slice, at(i));
            if (i > 0) from_neighbour(v, -1, at(i));
            if (i > 0 && before) from_neighbour(v, row - 1, at(i));
          }
          for (int i = nx - 2; i >= 0; --i) {
            const std::size_t v = first + std::size_t(i);
            from_neighbour(v, 1, at(i));
            if (before) from_neighbour(v, row + 1, at(i));
          }
        }
    }
  }
};

}  // namespace

grid::Grid<float> signed_distance_mm(const grid::Field& field, const Progress& progress) {
  const grid::Lattice& l = field;
  const Vec3 s = l.spacing_mm;
  Sweeper w{l, {}, std::vector<std::int32_t>(l.count(), -1), grid::Grid<float>(l, 1e6f)};
  // Surface points in each cell of the lattice: where the field crosses 0 along the cell's edges, the mean of these
  // points, and the midpoints between the mean and each of them. None is further from the surface than the surface
  // bends within a cell.
  const auto add = [&](Vec3 p) {
    w.points.push_back({p.x * s.x, p.y * s.y, p.z * s.z});
    const std::int32_t id = std::int32_t(w.points.size() - 1);
    for (int corner = 0; corner < 8; ++corner) {
      const int i = int(p.x) + (corner & 1), j = int(p.y) + (corner >> 1 & 1), k = int(p.z) + (corner >> 2);
      if (l.contains(i, j, k)) w.offer(l.index(i, j, k), {i * s.x, j * s.y, k * s.z}, id);
    }
  };
  for (int k = 0; k + 1 < l.size[2]; ++k)
    for (int j = 0; j + 1 < l.size[1]; ++j)
      for (int i = 0; i + 1 < l.size[0]; ++i) {
        int inside = 0;
        for (int corner = 0; corner < 8; ++corner)
          inside += field.at(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2)) > 0;
        if (inside == 0 || inside == 8) continue;
        Vec3 crossing[12], middle;
        int n = 0;
        for (int axis = 0; axis < 3; ++axis)
          for (int edge = 0; edge < 4; ++edge) {
            Vec3 from{double(i), double(j), double(k)};
            from[(axis + 1) % 3] += edge & 1;
            from[(axis + 2) % 3] += edge >> 1;
            Vec3 to = from;
            to[axis] += 1;
            const double f = field.at(int(from.x), int(from.y), int(from.z)),
                         g = field.at(int(to.x), int(to.y), int(to.z));
            if ((f > 0) == (g > 0)) continue;
            from[axis] += f / (f - g);
            middle += from;
            crossing[n++] = from;
          }
        if (!n) continue;
        middle = middle / n;
        add(middle);
        for (int c = 0; c < n; ++c) {
          add(crossing[c]);
          add(0.5 * (crossing[c] + middle));
        }
      }
  for (int round = 0; round < 2; ++round) {
    w.sweep(1, progress);
    w.sweep(-1, progress);
  }
  for (std::size_t v = 0; v < l.count(); ++v)
    if (!(field.voxels[v] > 0)) w.distance.voxels[v] = -w.distance.voxels[v];
  return std::move(w.distance);
}

}  // namespace trephine::mask
