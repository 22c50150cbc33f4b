// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "grid/grid.h"

namespace trephine::grid {

/// What a sample is beyond the centres of a lattice's outer voxels: what the outer voxels hold, up to `reach_voxels`
/// from their centres, and `value` further out.
struct Border {
  double value = 0;
  double reach_voxels = 0;
};
constexpr Border value_beyond(double value, double reach_voxels = 0) { return {value, reach_voxels}; }
constexpr Border nearest_beyond{0, std::numeric_limits<double>::infinity()};

/// Trilinear between the eight voxel centres around a place, given in voxels: along i, then j, then k. `at(n)` is the
/// voxel of index n; computed in Real. A place that is NaN lies beyond.
template <class Real = double, class At>
Real sampled(const Lattice& l, const At& at, Vec3 index, Border border) {
  std::array<int, 3> low;
  std::array<Real, 3> part;
  for (int a = 0; a < 3; ++a) {
    const int last = l.size[std::size_t(a)] - 1;
    if (!(index[a] >= -border.reach_voxels && index[a] <= last + border.reach_voxels)) return Real(border.value);
    const double x = std::clamp(index[a], 0.0, double(last));
    low[std::size_t(a)] = std::min(int(x), std::max(0, last - 1));
    part[std::size_t(a)] = Real(x - low[std::size_t(a)]);
  }
  // Along an axis of one voxel both ends are that voxel.
  const std::size_t n = l.index(low[0], low[1], low[2]), dx = l.size[0] > 1, dy = l.size[1] > 1 ? l.size[0] : 0,
                    dz = l.size[2] > 1 ? std::size_t(l.size[0]) * l.size[1] : 0;
  const auto row = [&](std::size_t m) {
    const Real a = Real(at(m)), b = Real(at(m + dx));
    return a + part[0] * (b - a);
  };
  const auto face = [&](std::size_t m) {
    const Real a = row(m), b = row(m + dy);
    return a + part[1] * (b - a);
  };
  const Real a = face(n), b = face(n + dz);
  return a + part[2] * (b - a);
}

template <class Real = double, class T>
Real sampled(const Grid<T>& grid, Vec3 index, Border border) {
  return sampled<Real>(
      grid, [&grid](std::size_t n) { return grid.voxels[n]; }, index, border);
}

}  // namespace trephine::grid
