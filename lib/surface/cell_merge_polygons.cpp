// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>

#include "surface/cell_boxes.h"
#include "surface/float_box.h"

namespace trephine::surface {
namespace {

/// A polygon's triangle must show at least this share of its longest side squared.
constexpr double least_area = 2e-3;
constexpr std::size_t longest_polygon = 48;

}  // namespace

/// Cuts the polygon into triangles that face along the normal, with the least area; no diagonal lies in a side of the
/// box. Returns false where there is no such cut.
bool CellMerge::cut_polygon(const Box& box, Vec3 normal, Room& room, std::vector<Triangle>& out) const {
  const std::size_t n = room.polygon.size();
  if (n < 3 || n > longest_polygon) return false;
  std::vector<Vec3> at(n);
  std::vector<int> sides(n);
  for (std::size_t i = 0; i < n; ++i) {
    at[i] = mm(room.polygon[i]);
    sides[i] = sides_of(cubes_.points_mm[room.polygon[i]], box.low, box.high);
  }
  constexpr double infinity = std::numeric_limits<double>::infinity();
  room.cost.assign(n * n, 0);
  room.split.assign(n * n, -1);
  for (std::size_t span = 2; span < n; ++span)
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t j = i + span;
      double& best = room.cost[i * n + j] = infinity;
      if (span != n - 1 && (sides[i] & sides[j])) continue;
      for (std::size_t k = i + 1; k < j; ++k) {
        const double parts = room.cost[i * n + k] + room.cost[k * n + j];
        if (!(parts < best) || (sides[i] & sides[k] & sides[j])) continue;
        const Vec3 a = at[k] - at[i], b = at[j] - at[i], across = cross(a, b);
        const double longest2 = std::max({dot(a, a), dot(b, b), dot(b - a, b - a)});
        if (!(dot(across, normal) > least_area * longest2)) continue;
        const double c = parts + norm(across);
        if (c < best) best = c, room.split[i * n + j] = static_cast<int>(k);
      }
    }
  if (!(room.cost[n - 1] < infinity)) return false;
  std::vector<std::array<std::size_t, 2>> parts{{0, n - 1}};
  while (!parts.empty()) {
    const auto [i, j] = parts.back();
    parts.pop_back();
    if (j - i < 2) continue;
    const auto k = static_cast<std::size_t>(room.split[i * n + j]);
    out.push_back({room.polygon[i], room.polygon[k], room.polygon[j]});
    parts.push_back({i, k});
    parts.push_back({k, j});
  }
  return true;
}

/// Makes the block's triangles. Boxes whose polygons cannot be cut, or meet, are divided; returns how many.
std::size_t CellMerge::cut(Block& block, Room& room) const {
  block.triangles.clear();
  std::size_t divided = 0;
  std::size_t border = 0;
  std::vector<FloatBox> boxes;
  for (int unit = 0; unit < units_in_block;) {
    const int level = block.level[unit], end = unit + (level == 0 ? 1 : units_of(level));
    if (level == 0)
      for (std::uint32_t n = block.of[unit]; n < block.of[end]; ++n)
        block.triangles.push_back(cubes_.triangles[order_[n]]);
    const std::size_t first = block.triangles.size();
    bool fits = true;
    for (; border < block.borders.size() && block.borders[border].unit == static_cast<std::uint32_t>(unit); ++border) {
      const std::size_t last =
          border + 1 < block.borders.size() ? block.borders[border + 1].begin : block.points.size();
      room.polygon.clear();
      for (std::size_t i = block.borders[border].begin; i < last; ++i)
        if (block.corner[i] || stays_[block.points[i]]) room.polygon.push_back(block.points[i]);
      fits = fits && cut_polygon(box_of(block, unit, level), block.borders[border].normal, room, block.triangles);
    }
    if (level > 0 && fits) {
      boxes.clear();
      for (std::size_t t = first; t < block.triangles.size(); ++t) {
        boxes.emplace_back();
        for (const std::uint32_t p : block.triangles[t]) boxes.back().add(cubes_.points_mm[p]);
      }
      const auto corners = [&](const Triangle& t) {
        return std::array<Vec3, 3>{cubes_.points_mm[t[0]], cubes_.points_mm[t[1]], cubes_.points_mm[t[2]]};
      };
      for (std::size_t s = first; s < block.triangles.size() && fits; ++s)
        for (std::size_t t = s + 1; t < block.triangles.size() && fits; ++t) {
          const Triangle &a = block.triangles[s], &b = block.triangles[t];
          if (!boxes[s - first].meets(boxes[t - first])) continue;
          if (std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end()) continue;
          fits = !meet_(a, corners(a), b, corners(b));
        }
    }
    if (!fits) {
      ++divided;
      std::fill(block.level.begin() + unit, block.level.begin() + end, static_cast<std::uint8_t>(level - 1));
    }
    unit = end;
  }
  return divided;
}

}  // namespace trephine::surface
