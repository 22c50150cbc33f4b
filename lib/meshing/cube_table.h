// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace trephine::meshing::cubes {

// Corner c of a cell lies at (c & 1, c >> 1 & 1, c >> 2 & 1). Its edges: 0-3 along x at (y, z) = (0,0), (1,0), (0,1),
// (1,1); 4-7 along y at (x, z) in the same order; 8-11 along z at (x, y) in the same order.
constexpr int edge_count = 12;

/// Corner at the edge's lower end, and its axis.
constexpr int edge_axis(int edge) { return edge / 4; }
constexpr int edge_corner(int edge) {
  const int n = edge % 4, lo = n & 1, hi = n >> 1;
  return edge / 4 == 0 ? (lo << 1 | hi << 2) : edge / 4 == 1 ? (lo | hi << 2) : (lo | hi << 1);
}

/// The corners of the six faces, counter-clockwise seen from outside the cell.
constexpr std::array<std::array<int, 4>, 6> face_corners{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

/// How the 256 configurations (bit c: corner c is inside) are cut. On an ambiguous face (two inside corners across a
/// diagonal) the inside corners are joined, so that a wall of a voxel's width has no holes. The surface in a cell is
/// one disc for each loop. No diagonal of a disc lies in a face of the cell, so cells share exactly the segments in
/// their faces, and the whole surface is closed and 2-manifold.
struct Table {
  std::array<std::uint16_t, 257> first{};  ///< signs -> begin and end in `edges`
  std::vector<std::uint8_t> edges;         ///< triples of edges: triangles that look from inside to outside
};

/// Built once, on first use.
const Table& table();

}  // namespace trephine::meshing::cubes
