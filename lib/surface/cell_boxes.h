// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of cell_merge: how boxes and units are numbered, and what a thread works with.
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "surface/cell_merge.h"

namespace trephine::surface {

inline int units_of(int level) { return 1 << 3 * (level - 1); }

/// Number of a unit in its block, so that those of smaller boxes follow each other.
inline int unit_at(int x, int y, int z) {
  return (x & 1) | (y & 1) << 1 | (z & 1) << 2 | (x & 2) << 2 | (y & 2) << 3 | (z & 2) << 4;
}

inline std::array<int, 3> place_of(int unit) {
  return {(unit & 1) | (unit >> 2 & 2), (unit >> 1 & 1) | (unit >> 3 & 2), (unit >> 2 & 1) | (unit >> 4 & 2)};
}

inline std::array<int, 3> cell_at(Vec3 p) {
  return {static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)), static_cast<int>(std::floor(p.z))};
}

/// On which sides of the box a point lies, a bit for each.
inline int sides_of(Vec3 p, Vec3 low, Vec3 high) {
  int sides = 0;
  for (int a = 0; a < 3; ++a) sides |= (p[a] == low[a]) << 2 * a | (p[a] == high[a]) << (2 * a + 1);
  return sides;
}

/// What one thread needs. After examine(): the patches of a box, with local numbers of their points.
struct CellMerge::Room {
  static constexpr std::uint32_t nothing = 0xffffffffu;
  std::vector<std::uint32_t> point, table, parent, next, border, faces, points;
  std::vector<int> sides;
  std::vector<Triangle> triangles;
  std::vector<Vec3> at, normals, sum;
  std::vector<double> low, high;
  std::vector<std::uint32_t> polygon, line;
  std::vector<int> split;
  std::vector<double> cost;

  std::uint32_t root(std::uint32_t n) {
    while (parent[n] != n) n = parent[n] = parent[parent[n]];
    return n;
  }
  void clear(std::size_t triangles_count) {
    std::size_t size = 16;
    while (size < 4 * triangles_count) size *= 2;
    table.assign(size, nothing);
    for (auto* v : {&point, &parent}) v->clear();
    for (auto* v : {&at, &normals}) v->clear();
    triangles.clear();
  }
  /// The local number of the point.
  std::uint32_t number(std::uint32_t p) {
    std::size_t slot = std::size_t{p} * 2654435761u & (table.size() - 1);
    for (; table[slot] != nothing; slot = (slot + 1) & (table.size() - 1))
      if (point[table[slot]] == p) return table[slot];
    const auto n = static_cast<std::uint32_t>(point.size());
    table[slot] = n;
    point.push_back(p);
    parent.push_back(n);
    return n;
  }
};

}  // namespace trephine::surface
