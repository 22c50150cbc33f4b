// SPDX-License-Identifier: GPL-3.0-or-later
// The tragus, from the map of how far the side of the head reaches outwards.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "head/landmarks_parts.h"
#include "mask/filters.h"

namespace trephine::head {
namespace {

/// Millimetres from the midsagittal plane to the outermost skin, on a raster of 1 mm: columns to the back, rows down.
struct SideMap {
  static constexpr int columns = 141, rows = 151, column_at_origin = 65, row_at_origin = 40;
  std::vector<float> reach_mm = std::vector<float>(columns * rows, 0.f);  ///< 0 where there is no skin
  float operator()(int column, int row) const { return reach_mm[row * columns + column]; }
};

SideMap side_map(const craniometry::FieldView& skin, const HeadFrame& head, int side) {
  SideMap map;
  parallel_for(0, SideMap::rows, 4, [&](std::int64_t from, std::int64_t to) {
    for (int row = int(from); row < to; ++row)
      for (int column = 0; column < SideMap::columns; ++column) {
        const Vec3 p = head.origin_mm + head.back * (column - SideMap::column_at_origin) +
                       head.up * (SideMap::row_at_origin - row) + head.left * (side * 130.0);
        if (const auto q = skin.enter(p, head.left * (-1.0 * side), 100, 0.9))
          map.reach_mm[row * SideMap::columns + column] = float(dot(*q - head.origin_mm, head.left) * side);
      }
  });
  return map;
}

/// How far below the line from the higher ground in front to that behind, along each row: pits of up to 30 mm.
std::vector<float> pit_depth(const SideMap& map) {
  constexpr int half = 15, n = SideMap::columns;
  std::vector<float> depth(map.reach_mm.size(), 0.f);
  for (int row = 0; row < SideMap::rows; ++row)
    for (int c = half; c + half < n; ++c) {
      if (map(c, row) <= 0) continue;
      float front = 0, behind = 0;
      for (int t = 1; t <= half; ++t) {
        front = std::max(front, map(c - t, row));
        behind = std::max(behind, map(c + t, row));
      }
      depth[row * n + c] = std::max(0.f, std::min(front, behind) - map(c, row));
    }
  return depth;
}

/// How far behind the auricle's free edge lies, the nearest step of 8 mm down within 3 mm; 99 where there is none.
int to_free_edge_mm(const SideMap& map, int column, int row) {
  for (int c = column + 4; c <= std::min(column + 38, SideMap::columns - 5); ++c)
    for (int t = 1; t <= 3; ++t)
      if (map(c + t, row) > 0 && map(c, row) - map(c + t, row) >= 8) return c - column;
  return 99;
}

/// Gaussian of sigma 1 mm over what is skin.
SideMap smoothed(const SideMap& map) {
  SideMap out;
  for (int row = 2; row + 2 < SideMap::rows; ++row)
    for (int c = 2; c + 2 < SideMap::columns; ++c) {
      if (map(c, row) <= 0) continue;
      double sum = 0, weights = 0;
      for (int y = -2; y <= 2; ++y)
        for (int x = -2; x <= 2; ++x)
          if (map(c + x, row + y) > 0) {
            const double w = std::exp(-0.5 * (x * x + y * y));
            sum += w * map(c + x, row + y), weights += w;
          }
      out.reach_mm[row * SideMap::columns + c] = float(sum / weights);
    }
  return out;
}

/// The top of the pit's front wall along a row: forwards from its deepest point up to the first shoulder, which is the
/// tragus also where a cheek rises higher in front of it.
struct Rim {
  int column = 0;
  double height_mm = 0;  ///< above the pit's deepest point
};
std::optional<Rim> front_rim(const SideMap& map, int from, int to, int row) {
  int deepest = -1;
  for (int c = from; c <= to; ++c)
    if (map(c, row) > 0 && (deepest < 0 || map(c, row) < map(deepest, row))) deepest = c;
  constexpr double min_rise_mm = 2, shoulder = 0.35, level = 0.05;
  double steepest = 0;
  for (int c = deepest, end = std::max(4, deepest - 20); c > end; --c) {
    if (map(c, row) <= 0 || map(c - 1, row) <= 0) return {};
    const double slope = map(c - 1, row) - map(c, row), risen = map(c, row) - map(deepest, row);
    steepest = std::max(steepest, slope);
    if (risen < min_rise_mm || slope > shoulder * std::min(1.0, 2 * steepest)) continue;
    for (int t = 0; t < 3 && c > end && map(c - 1, row) - map(c, row) > level; ++t) --c;
    return Rim{c, double(map(c, row)) - map(deepest, row)};
  }
  return {};
}

}  // namespace

std::optional<FoundPoint> find_tragus(const craniometry::FieldView& skin, const HeadFrame& head, int side) {
  const SideMap map = side_map(skin, head, side);
  constexpr int n = SideMap::columns;
  std::vector<float> depth = pit_depth(map);
  for (int row = 0; row < SideMap::rows; ++row)
    for (int c = 0; c < n; ++c)
      if (depth[row * n + c] > 0) depth[row * n + c] *= float(mask::ramp(to_free_edge_mm(map, c, row), 36, 22));
  // The concha: where most of a pit lies together.
  constexpr int window = 6;
  double most = 0;
  int at_column = 0, at_row = 0;
  for (int row = window; row + window < SideMap::rows; ++row)
    for (int c = window + 15; c + window < n; ++c) {
      double sum = 0;
      for (int y = -window; y <= window; ++y)
        for (int x = -window; x <= window; ++x) sum += std::min(12.f, depth[(row + y) * n + c + x]);
      if (sum > most) most = sum, at_column = c, at_row = row;
    }
  const double mean_depth_mm = most / ((2 * window + 1) * (2 * window + 1));
  if (mean_depth_mm < 0.3) return {};

  // Its front rim, in the row where that stands highest above the pit.
  const SideMap smooth = smoothed(map);
  double best = 0;
  int rim_column = 0, rim_row = 0;
  for (int row = std::max(6, at_row - 12); row <= std::min(SideMap::rows - 7, at_row + 12); ++row)
    if (const auto rim = front_rim(smooth, at_column - 6, std::min(n - 4, at_column + 12), row)) {
      // Near the concha's middle, and next to it: a cheek lies farther to the front.
      const double away = (row - at_row) / 4.0, ahead = std::max(0, at_column - rim->column) / 12.0;
      const double height = rim->height_mm * std::exp(-0.5 * away * away - ahead);
      if (height > best) best = height, rim_column = rim->column, rim_row = row;
    }
  if (best <= 0) return {};
  // A tragus that stands out as a bump has its own top within 3 mm.
  int top_column = rim_column, top_row = rim_row;
  for (int y = -4; y <= 4; ++y)
    for (int x = -4; x <= 4; ++x)
      if (x * x + y * y <= 16 && smooth(rim_column + x, rim_row + y) > smooth(top_column, top_row))
        top_column = rim_column + x, top_row = rim_row + y;
  if (std::hypot(top_column - rim_column, top_row - rim_row) <= 3) rim_column = top_column, rim_row = top_row;

  FoundPoint found;
  const Vec3 from = head.origin_mm + head.back * (rim_column - SideMap::column_at_origin) +
                    head.up * (SideMap::row_at_origin - rim_row) + head.left * (side * 130.0);
  const auto on_skin = skin.enter(from, head.left * (-1.0 * side), 100);
  if (!on_skin) return {};
  found.position_mm = *on_skin;
  // An ear that the scan cuts off below shows the root of the helix as a rim: the whole auricle must be there.
  constexpr double lobe_mm = 24;
  found.confidence = std::min({mask::ramp(mean_depth_mm, 0.3, 1), mask::ramp(best, 0.3, 1),
                               mask::ramp(skin.depth_in_scan_mm(found.position_mm), 2, 12),
                               mask::ramp(scanned_below_mm(skin, found.position_mm, head.up, lobe_mm), 10, lobe_mm)});
  return found;
}

}  // namespace trephine::head
