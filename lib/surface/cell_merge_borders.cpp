// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <tuple>

#include "surface/cell_boxes.h"

namespace trephine::surface {
namespace {

double squared_to_segment(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 ab = b - a, ap = p - a;
  const double length2 = dot(ab, ab), t = length2 > 0 ? std::clamp(dot(ap, ab) / length2, 0.0, 1.0) : 0;
  const Vec3 d = ap - ab * t;
  return dot(d, d);
}

}  // namespace

CellMerge::Where CellMerge::where(const std::array<int, 3>& cell) const {
  int b[3], u[3];
  for (int a = 0; a < 3; ++a) {
    const int n = (cell[a] - low_[a]) / unit_[a];
    b[a] = n / units;
    u[a] = n % units;
  }
  Where w;
  w.block = block_at_[(std::size_t(b[2]) * count_[1] + b[1]) * count_[0] + b[0]];
  const int unit = unit_at(u[0], u[1], u[2]);
  w.level = blocks_[w.block].level[unit];
  w.unit = w.level == 0 ? unit : unit & ~(units_of(w.level) - 1);
  return w;
}

/// How many boxes meet at the point, at most 3, and the one beside `own` where there are two. Where nothing is merged
/// beside it, 3. All four cells around its lattice edge hold triangles.
int CellMerge::others(std::uint32_t point, const Where& own, Where& other) const {
  const Vec3 p = cubes_.points_mm[point];
  const std::array<int, 3> low = cell_at(p);
  const int axis = p.x != low[0] ? 0 : p.y != low[1] ? 1 : 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  int found = 1;
  for (int n = 0; n < 4; ++n) {
    std::array<int, 3> cell = low;
    cell[u] -= n & 1;
    cell[v] -= n >> 1;
    const Where w = where(cell);
    if (w.level == 0) return 3;
    if (w.same(own) || (found == 2 && w.same(other))) continue;
    if (++found > 2) return 3;
    other = w;
  }
  return found;
}

/// Follows the borders of the patches in the block's boxes, and thins the parts of them that are this box's to thin.
void CellMerge::trace(std::int32_t at, Room& room) {
  Block& block = blocks_[at];
  block.borders.clear();
  block.points.clear();
  block.corner.clear();
  for (int unit = 0; unit < units_in_block;) {
    const int level = block.level[unit], end = unit + (level == 0 ? 1 : units_of(level));
    if (level > 0 && block.of[unit] != block.of[end]) {
      examine(block, unit, level, room);
      const Where own{at, unit, level};
      std::vector<Where> beside;
      for (std::uint32_t p = 0; p < room.point.size(); ++p) {
        if (room.next[p] == Room::nothing) continue;
        const auto begin = static_cast<std::uint32_t>(block.points.size());
        block.borders.push_back({begin, static_cast<std::uint32_t>(unit), room.sum[room.root(p)]});
        beside.clear();
        for (std::uint32_t q = p; room.next[q] != Room::nothing;) {
          const std::uint32_t onward = room.next[q];
          room.next[q] = Room::nothing;
          beside.push_back(own);
          block.points.push_back(room.point[q]);
          block.corner.push_back(others(room.point[q], own, beside.back()) != 2);
          q = onward;
        }
        const std::size_t n = beside.size();
        std::size_t start = 0;
        while (start < n && !block.corner[begin + start]) ++start;
        const auto mine = [&](const Where& o) { return std::tie(at, unit) < std::tie(o.block, o.unit); };
        if (start == n) {  // all of it runs over one side: it stays
          if (mine(beside[0]))
            for (std::size_t i = 0; i < n; ++i) stays_[block.points[begin + i]] = 1;
          continue;
        }
        for (std::size_t i = start; i < start + n;) {
          room.line.assign(1, block.points[begin + i % n]);
          std::size_t j = i + 1;
          for (; !block.corner[begin + j % n]; ++j) room.line.push_back(block.points[begin + j % n]);
          room.line.push_back(block.points[begin + j % n]);
          if (room.line.size() > 2 && mine(beside[(i + 1) % n])) {
            const Vec3 a = cubes_.points_mm[room.line.front()], b = cubes_.points_mm[room.line.back()];
            thin(room.line, (a.x == b.x) + (a.y == b.y) + (a.z == b.z) >= 2);
          }
          i = j;
        }
      }
    }
    unit = end;
  }
}

/// Says which points of a line between two corners stay. Where it must not become a straight one, for that would lie on
/// an edge of a box, its farthest point stays in any case.
void CellMerge::thin(const std::vector<std::uint32_t>& line, bool bend) {
  for (std::size_t i = 1; i + 1 < line.size(); ++i) stays_[line[i]] = 0;
  std::vector<std::array<std::size_t, 2>> parts{{0, line.size() - 1}};
  while (!parts.empty()) {
    const auto [from, to] = parts.back();
    parts.pop_back();
    const Vec3 a = mm(line[from]), b = mm(line[to]);
    double far2 = -1;
    std::size_t farthest = from;
    for (std::size_t i = from + 1; i < to; ++i)
      if (const double d2 = squared_to_segment(mm(line[i]), a, b); d2 > far2) far2 = d2, farthest = i;
    if (farthest == from || (far2 <= aside_ * aside_ && !bend)) continue;
    bend = false;
    stays_[line[farthest]] = 1;
    parts.push_back({from, farthest});
    parts.push_back({farthest, to});
  }
}

}  // namespace trephine::surface
