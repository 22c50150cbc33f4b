// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>

#include "grid/grid.h"
#include "surface/trimesh.h"

namespace trephine::surface {

/// Grows the box to hold another. Empty bounds become the first box that they are given.
inline void include(Bounds& all, const Bounds& more) {
  for (int a = 0; a < 3; ++a) {
    all.min_mm[a] = std::min(all.min_mm[a], more.min_mm[a]);
    all.max_mm[a] = std::max(all.max_mm[a], more.max_mm[a]);
  }
}
inline void include(Bounds& all, Vec3 point_mm) { include(all, Bounds{point_mm, point_mm}); }

/// The corners of a box; x runs fastest. The first is the least corner, the last the largest.
std::array<Vec3, 8> corners_of(const Bounds& b);
/// The corners of the box of the lattice's voxels, in the world: of their centres, or, with beyond_voxels = 0.5, of all
/// that they fill; i runs fastest.
std::array<Vec3, 8> corners_of(const grid::Lattice& lattice, double beyond_voxels = 0);
/// World bounds of the same.
Bounds bounds_of(const grid::Lattice& lattice, double beyond_voxels = 0);

/// Least and largest continuous index of a world box's corners, on the lattice and beyond it.
struct IndexBounds {
  Vec3 low, high;
};
IndexBounds index_bounds(const grid::Lattice& lattice, const Bounds& bounds_mm);

}  // namespace trephine::surface
