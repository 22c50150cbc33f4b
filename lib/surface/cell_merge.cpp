// SPDX-License-Identifier: GPL-3.0-or-later
// Which boxes there are. Their borders are in cell_merge_borders.cpp, their triangles in cell_merge_polygons.cpp.
#include "surface/cell_merge.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "surface/cell_boxes.h"

namespace trephine::surface {
namespace {

/// Shares of the bound for the distance between a patch's planes and for what thins its border.
constexpr double apart_share = 0.9, aside_share = 0.43;
/// Where the spacing is larger than this many times the least one, a box has half as many cells.
constexpr double wide_spacing = 1.5;
/// How much of its area a triangle must at least show along its patch's normal.
constexpr double least_facing = 0.05;
constexpr int top_level = 3;

}  // namespace

Vec3 CellMerge::mm(std::uint32_t point) const {
  const Vec3 p = cubes_.points_mm[point];
  return {p.x * spacing_.x, p.y * spacing_.y, p.z * spacing_.z};
}

CellMerge::CellMerge(const TriMesh& cubes, Vec3 spacing_mm, double within_mm, Meet meet, const Progress& progress)
    : cubes_(cubes),
      spacing_(spacing_mm),
      apart_(apart_share * within_mm),
      aside_(aside_share * within_mm),
      meet_(meet),
      stays_(cubes.points_mm.size(), 1) {
  const double least = std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  for (int a = 0; a < 3; ++a) unit_[a] = spacing_mm[a] > wide_spacing * least ? 1 : 2;
  sort();
  progress.report(0.2);
  parallel_for(0, static_cast<std::int64_t>(blocks_.size()), 64, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    Room room;
    for (std::int64_t b = from; b < to; ++b) choose(blocks_[b], room);
  });
  progress.report(0.6);
  std::vector<std::int32_t> all(blocks_.size());
  std::iota(all.begin(), all.end(), 0);
  settle(std::move(all), progress);
  progress.report(1);
}

/// Finds the blocks and puts the triangles in their order.
void CellMerge::sort() {
  const auto triangles = static_cast<std::int64_t>(cubes_.triangles.size());
  std::vector<std::array<int, 3>> cell(cubes_.triangles.size());
  parallel_for(0, triangles, 16384, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t t = from; t < to; ++t) {
      const Triangle& v = cubes_.triangles[t];
      cell[t] = cell_at((cubes_.points_mm[v[0]] + cubes_.points_mm[v[1]] + cubes_.points_mm[v[2]]) / 3);
    }
  });
  std::array<int, 3> high{};
  for (std::size_t t = 0; t < cell.size(); ++t)
    for (int a = 0; a < 3; ++a) {
      low_[a] = t == 0 ? cell[t][a] : std::min(low_[a], cell[t][a]);
      high[a] = t == 0 ? cell[t][a] : std::max(high[a], cell[t][a]);
    }
  for (int a = 0; a < 3; ++a) count_[a] = (high[a] - low_[a]) / (units * unit_[a]) + 1;
  block_at_.assign(std::size_t(count_[0]) * count_[1] * count_[2], -1);
  std::vector<std::uint32_t> size(block_at_.size(), 0), at(cell.size());
  std::vector<std::uint8_t> unit(cell.size());
  for (std::size_t t = 0; t < cell.size(); ++t) {
    int b[3], u[3];
    for (int a = 0; a < 3; ++a) {
      const int n = (cell[t][a] - low_[a]) / unit_[a];
      b[a] = n / units;
      u[a] = n % units;
    }
    at[t] = static_cast<std::uint32_t>((std::size_t(b[2]) * count_[1] + b[1]) * count_[0] + b[0]);
    unit[t] = static_cast<std::uint8_t>(unit_at(u[0], u[1], u[2]));
    ++size[at[t]];
  }
  std::uint32_t first = 0;
  for (std::size_t b = 0; b < size.size(); ++b) {
    if (size[b] == 0) continue;
    block_at_[b] = static_cast<std::int32_t>(blocks_.size());
    Block block;
    const int x = static_cast<int>(b % count_[0]), y = static_cast<int>(b / count_[0] % count_[1]),
              z = static_cast<int>(b / count_[0] / count_[1]);
    block.low = {low_[0] + x * units * unit_[0], low_[1] + y * units * unit_[1], low_[2] + z * units * unit_[2]};
    block.first = block.end = first;
    block.of.fill(0);
    first += size[b];
    blocks_.push_back(std::move(block));
  }
  for (std::size_t t = 0; t < cell.size(); ++t) ++blocks_[block_at_[at[t]]].of[unit[t] + 1];
  for (Block& block : blocks_) {
    block.of[0] = block.first;
    for (int u = 0; u < units_in_block; ++u) block.of[u + 1] += block.of[u];
    block.end = block.of[units_in_block];
  }
  order_.resize(cell.size());
  std::vector<std::array<std::uint32_t, units_in_block>> next(blocks_.size());
  for (std::size_t b = 0; b < blocks_.size(); ++b) std::copy_n(blocks_[b].of.begin(), units_in_block, next[b].begin());
  for (std::size_t t = 0; t < cell.size(); ++t)
    order_[next[block_at_[at[t]]][unit[t]]++] = static_cast<std::uint32_t>(t);
}

CellMerge::Box CellMerge::box_of(const Block& block, int unit, int level) const {
  const auto at = place_of(unit);
  Box box;
  for (int a = 0; a < 3; ++a) {
    box.low[a] = block.low[a] + at[a] * unit_[a];
    box.high[a] = box.low[a] + (unit_[a] << (level - 1));
  }
  return box;
}

/// Whether the patches in the box can be merged; they then stand in the room.
bool CellMerge::examine(const Block& block, int unit, int level, Room& room) const {
  const std::uint32_t first = block.of[unit], end = block.of[unit + units_of(level)];
  room.clear(end - first);
  for (std::uint32_t n = first; n < end; ++n) {
    const Triangle& t = cubes_.triangles[order_[n]];
    const Triangle v{room.number(t[0]), room.number(t[1]), room.number(t[2])};
    for (const std::uint32_t p : {v[1], v[2]}) room.parent[room.root(p)] = room.root(v[0]);
    room.triangles.push_back(v);
  }
  const std::size_t count = room.point.size();
  const Box box = box_of(block, unit, level);
  room.sides.resize(count);
  for (std::size_t n = 0; n < count; ++n) {
    room.sides[n] = sides_of(cubes_.points_mm[room.point[n]], box.low, box.high);
    room.at.push_back(mm(room.point[n]));
  }
  room.next.assign(count, Room::nothing);
  for (auto* v : {&room.border, &room.faces, &room.points}) v->assign(count, 0);
  room.sum.assign(count, {});
  for (const Triangle& t : room.triangles) {
    const std::uint32_t r = room.root(t[0]);
    const Vec3 a = room.at[t[0]];
    room.normals.push_back(cross(room.at[t[1]] - a, room.at[t[2]] - a));
    room.sum[r] += room.normals.back();
    ++room.faces[r];
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t p = t[c], q = t[c == 2 ? 0 : c + 1];
      if (!(room.sides[p] & room.sides[q])) continue;
      if (room.next[p] != Room::nothing) return false;
      room.next[p] = q;
      ++room.border[r];
    }
  }
  constexpr double infinity = std::numeric_limits<double>::infinity();
  room.low.assign(count, infinity);
  room.high.assign(count, -infinity);
  for (std::uint32_t p = 0; p < count; ++p) {
    const std::uint32_t r = room.root(p);
    if (room.points[r]++ == 0) room.sum[r] = normalized(room.sum[r]);
    const double h = dot(room.sum[r], room.at[p]);
    room.low[r] = std::min(room.low[r], h);
    room.high[r] = std::max(room.high[r], h);
  }
  for (std::uint32_t r = 0; r < count; ++r) {
    if (room.parent[r] != r) continue;
    // Euler's number of a disc is 1, with (3 faces + border) / 2 edges.
    if (2 * room.points[r] != 2 + room.faces[r] + room.border[r] || room.high[r] - room.low[r] > apart_) return false;
  }
  for (std::size_t t = 0; t < room.triangles.size(); ++t) {
    const Vec3 n = room.normals[t];
    const double along = dot(n, room.sum[room.root(room.triangles[t][0])]);
    if (!(along > 0 && along * along > least_facing * least_facing * dot(n, n))) return false;
  }
  return true;
}

/// The largest boxes whose patches, and those of all smaller boxes in them, can be merged.
void CellMerge::choose(Block& block, Room& room) const {
  for (int level = 1; level <= top_level; ++level)
    for (int unit = 0; unit < units_in_block; unit += units_of(level)) {
      const int end = unit + units_of(level);
      if (block.of[unit] == block.of[end]) continue;
      bool fits = true;
      for (int u = unit; u < end && fits; ++u) fits = block.of[u] == block.of[u + 1] || block.level[u] == level - 1;
      if (fits && examine(block, unit, level, room))
        std::fill(block.level.begin() + unit, block.level.begin() + end, static_cast<std::uint8_t>(level));
    }
}

/// The blocks and those beside them, ascending.
std::vector<std::int32_t> CellMerge::around(const std::vector<std::int32_t>& blocks) const {
  if (blocks.size() == blocks_.size()) return blocks;
  std::vector<std::int32_t> out;
  for (const std::int32_t b : blocks) {
    int at[3];
    for (int a = 0; a < 3; ++a) at[a] = (blocks_[b].low[a] - low_[a]) / (units * unit_[a]);
    for (int z = std::max(0, at[2] - 1); z < std::min(count_[2], at[2] + 2); ++z)
      for (int y = std::max(0, at[1] - 1); y < std::min(count_[1], at[1] + 2); ++y)
        for (int x = std::max(0, at[0] - 1); x < std::min(count_[0], at[0] + 2); ++x)
          if (const auto n = block_at_[(std::size_t(z) * count_[1] + y) * count_[0] + x]; n >= 0) out.push_back(n);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Makes the triangles of blocks whose boxes changed, and of those beside them, until no box has to be divided.
void CellMerge::settle(std::vector<std::int32_t> changed, const Progress& progress) {
  while (!changed.empty()) {
    const std::vector<std::int32_t> blocks = around(changed);
    const auto count = static_cast<std::int64_t>(blocks.size());
    parallel_for(0, count, 64, [&](std::int64_t from, std::int64_t to) {
      progress.check();
      Room room;
      for (std::int64_t n = from; n < to; ++n) trace(blocks[n], room);
    });
    std::vector<std::size_t> divided(blocks.size(), 0);
    parallel_for(0, count, 64, [&](std::int64_t from, std::int64_t to) {
      progress.check();
      Room room;
      for (std::int64_t n = from; n < to; ++n) divided[n] = cut(blocks_[blocks[n]], room);
    });
    changed.clear();
    for (std::size_t n = 0; n < blocks.size(); ++n) {
      if (divided[n] > 0) changed.push_back(blocks[n]);
      boxes_divided_count_ += divided[n];
    }
  }
}

std::size_t CellMerge::divide(const std::vector<Vec3>& places, const Progress& progress) {
  constexpr double rounding = 0.01;
  std::vector<std::array<int, 2>> boxes;  // block, unit
  for (std::size_t n = 0; n < 8 * places.size(); ++n) {
    const auto cell = cell_at(
        places[n / 8] + Vec3{n & 1 ? rounding : -rounding, n & 2 ? rounding : -rounding, n & 4 ? rounding : -rounding});
    bool there = true;
    for (int a = 0; a < 3; ++a) there = there && cell[a] >= low_[a] && cell[a] < low_[a] + count_[a] * units * unit_[a];
    int b[3] = {0, 0, 0};
    for (int a = 0; a < 3 && there; ++a) b[a] = (cell[a] - low_[a]) / (units * unit_[a]);
    if (!there || block_at_[(std::size_t(b[2]) * count_[1] + b[1]) * count_[0] + b[0]] < 0) continue;
    if (const Where w = where(cell); w.level > 0) boxes.push_back({w.block, w.unit});
  }
  std::sort(boxes.begin(), boxes.end());
  boxes.erase(std::unique(boxes.begin(), boxes.end()), boxes.end());
  std::vector<std::int32_t> changed;
  for (const auto& [b, unit] : boxes) {
    auto& level = blocks_[b].level;
    const int now = level[unit];
    std::fill_n(level.begin() + unit, units_of(now), static_cast<std::uint8_t>(now - 1));
    if (changed.empty() || changed.back() != b) changed.push_back(b);
  }
  boxes_divided_count_ += boxes.size();
  settle(std::move(changed), progress);
  return boxes.size();
}

TriMesh CellMerge::mesh() const {
  constexpr std::uint32_t unused = 0xffffffffu;
  TriMesh out;
  std::size_t count = 0;
  for (const Block& block : blocks_) count += block.triangles.size();
  std::vector<std::uint32_t> number(cubes_.points_mm.size(), 0);
  for (const Block& block : blocks_)
    for (const Triangle& t : block.triangles)
      for (const std::uint32_t p : t) number[p] = 1;
  std::uint32_t next = 0;
  for (auto& n : number) n = n ? next++ : unused;
  out.points_mm.resize(next);
  for (std::size_t p = 0; p < number.size(); ++p)
    if (number[p] != unused) out.points_mm[number[p]] = cubes_.points_mm[p];
  out.triangles.reserve(count);
  for (const Block& block : blocks_)
    for (const Triangle& t : block.triangles) out.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  return out;
}

}  // namespace trephine::surface
