// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/vec3.h"

namespace trephine::tetra {

/// What the mesher made, before the parent knows it. Regions are numbered from the smallest surface on.
struct Filled {
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 4>> tetrahedra;
  std::vector<std::uint8_t> region_of;
  std::vector<std::array<std::uint32_t, 3>> borders;
  std::vector<std::array<std::uint8_t, 2>> between;
};

/// CGAL's containers are walked in an order of their own; this is one of the content alone. Points are numbered by
/// place, from below, and cells by their corners, each from its least corner on.
Filled in_order(const Filled& found);

/// Where so few tetrahedra of a region hang together that no more of it is beside them, they go to the region with
/// which they share the most faces: for who computes with a region, they would hang by an edge or a corner. Returns how
/// many did.
std::uint64_t join_lone_cells(Filled& filled);

/// Fills `borders` and `between` with the faces between regions, in the order of their corners.
void add_borders(Filled& filled);

}  // namespace trephine::tetra
