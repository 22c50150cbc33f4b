// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/bounds.h"

#include <cstddef>

namespace trephine::surface {

std::array<Vec3, 8> corners_of(const Bounds& b) {
  std::array<Vec3, 8> corners;
  for (unsigned c = 0; c < 8; ++c)
    corners[c] = {c & 1 ? b.max_mm.x : b.min_mm.x, c & 2 ? b.max_mm.y : b.min_mm.y, c & 4 ? b.max_mm.z : b.min_mm.z};
  return corners;
}

std::array<Vec3, 8> corners_of(const grid::Lattice& lattice, double beyond_voxels) {
  const auto last = [&](std::size_t axis) { return lattice.size[axis] - 1 + beyond_voxels; };
  const double first = 0 - beyond_voxels;
  auto corners = corners_of(Bounds{{first, first, first}, {last(0), last(1), last(2)}});
  for (Vec3& c : corners) c = lattice.to_world_mm(c);
  return corners;
}

Bounds bounds_of(const grid::Lattice& lattice, double beyond_voxels) {
  Bounds b;
  for (const Vec3 corner : corners_of(lattice, beyond_voxels)) include(b, corner);
  return b;
}

IndexBounds index_bounds(const grid::Lattice& lattice, const Bounds& bounds_mm) {
  Bounds indices;
  for (const Vec3 corner : corners_of(bounds_mm)) include(indices, lattice.to_index(corner));
  return {indices.min_mm, indices.max_mm};
}

}  // namespace trephine::surface
