// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>

namespace trephine::drill::detail {

/// The triangles of a cell by which of its corners are solid. Corner n has x = n & 1, y = n >> 1 & 1, z = n >> 2. Edge
/// 4 a + m of axis a is the m-th of those along it: its low corner has the bits of m at the two other axes, ascending.
struct CellTriangles {
  int count = 0;                        ///< triangles
  std::array<std::uint8_t, 36> edge{};  ///< three a triangle, counter-clockwise from the empty side
};

/// By the set of solid corners. On a face with two solid corners across from each other these are kept apart, in both
/// cells that share it, so that surfaces of neighbouring cells fit together.
const std::array<CellTriangles, 256>& cell_triangles();

/// The low corner of an edge.
constexpr int low_corner(int edge) {
  const int axis = edge >> 2, m = edge & 3;
  return axis == 0 ? m << 1 : axis == 1 ? (m & 1) | (m & 2) << 1 : m;
}

}  // namespace trephine::drill::detail
