// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "surface/bounds.h"

namespace trephine::surface {
namespace {

/// Spreads 21 bits to every third bit.
std::uint64_t spread(std::uint64_t v) {
  v = (v | v << 32) & 0x1f00000000ffffull;
  v = (v | v << 16) & 0x1f0000ff0000ffull;
  v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

constexpr std::int64_t grain = 16384;

/// Sorts by both keys: a radix sort over the upper bits of the first key, eleven at a time, then comparisons among the
/// few that agree in these bits.
void sort_by_key(std::vector<std::pair<std::uint64_t, std::uint32_t>>& keys) {
  if (keys.size() < 4096) {
    std::sort(keys.begin(), keys.end());
    return;
  }
  constexpr int bits = 11, lowest = 63 - 3 * bits;
  constexpr std::int64_t piece = 1 << 17;
  const auto count = static_cast<std::int64_t>(keys.size());
  std::vector<std::pair<std::uint64_t, std::uint32_t>> other(keys.size());
  using Places = std::array<std::uint32_t, 1 << bits>;
  std::vector<Places> at((count + piece - 1) / piece);
  for (int shift = lowest; shift < 63; shift += bits) {
    const auto digit = [&](std::int64_t n) { return keys[n].first >> shift & ((1 << bits) - 1); };
    parallel_for(0, count, piece, [&](std::int64_t from, std::int64_t to) {
      Places& own = at[from / piece];
      own.fill(0);
      for (std::int64_t n = from; n < to; ++n) ++own[digit(n)];
    });
    std::uint32_t sum = 0;
    for (std::size_t d = 0; d < at[0].size(); ++d)
      for (Places& own : at) sum += std::exchange(own[d], sum);
    parallel_for(0, count, piece, [&](std::int64_t from, std::int64_t to) {
      Places& own = at[from / piece];
      for (std::int64_t n = from; n < to; ++n) other[own[digit(n)]++] = keys[n];
    });
    keys.swap(other);
  }
  const auto differ = [&](std::int64_t n) { return keys[n - 1].first >> lowest != keys[n].first >> lowest; };
  parallel_for(0, count, piece, [&](std::int64_t from, std::int64_t to) {
    // A piece sorts the groups that begin in it.
    while (from > 0 && from < to && !differ(from)) ++from;
    while (from < to) {
      std::int64_t end = from + 1;
      while (end < count && !differ(end)) ++end;
      if (end - from > 1) std::sort(keys.begin() + from, keys.begin() + end);
      from = end;
    }
  });
}

}  // namespace

TriangleTree::TriangleTree(const TriMesh& mesh) : mesh_(mesh) {
  const auto count = static_cast<std::int64_t>(mesh.triangles.size());
  FloatBox all;
  Bounds exact;  // so that only two points are rounded
  for (const Vec3 p : mesh.points_mm) include(exact, p);
  if (!mesh.points_mm.empty()) all.add(exact.min_mm), all.add(exact.max_mm);
  double extent = 0;
  for (int a = 0; a < 3; ++a) extent = std::max(extent, double(all.max[a]) - all.min[a]);
  const double scale = extent > 0 ? 2097151 / extent : 0;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(count);
  parallel_for(0, count, grain, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t t = from; t < to; ++t) {
      const auto& v = mesh.triangles[t];
      const Vec3 c = (mesh.points_mm[v[0]] + mesh.points_mm[v[1]] + mesh.points_mm[v[2]]) / 3;
      std::uint64_t key = 0;
      for (int a = 0; a < 3; ++a)
        key |= spread(static_cast<std::uint64_t>(std::clamp((c[a] - all.min[a]) * scale, 0.0, 2097151.0))) << a;
      keys[t] = {key, static_cast<std::uint32_t>(t)};
    }
  });
  sort_by_key(keys);
  order_.resize(count);
  for (std::int64_t n = 0; n < count; ++n) order_[n] = keys[n].second;
  keys = {};

  boxes_.resize(count);
  levels_.emplace_back((count + width - 1) / width);
  parallel_for(0, static_cast<std::int64_t>(levels_[0].size()), grain / width, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t leaf = from; leaf < to; ++leaf)
      for (std::int64_t n = width * leaf; n < std::min<std::int64_t>(width * (leaf + 1), count); ++n) {
        for (const std::uint32_t v : mesh.triangles[order_[n]]) boxes_[n].add(mesh.points_mm[v]);
        levels_[0][leaf].add(boxes_[n]);
      }
  });
  while (levels_.back().size() > 1) {
    const auto& below_level = levels_.back();
    std::vector<FloatBox> level((below_level.size() + width - 1) / width);
    for (std::size_t n = 0; n < below_level.size(); ++n) level[n / width].add(below_level[n]);
    levels_.push_back(std::move(level));
  }
}

double TriangleTree::squared_distance(Vec3 p, double squared_limit, std::uint32_t* triangle) const {
  double best = squared_limit;
  visit_nearest(
      best, [&](const FloatBox& box) { return box.squared_distance(p); },
      [&](std::size_t leaf) {
        for (std::size_t n = width * leaf; n < std::min(width * (leaf + 1), order_.size()); ++n) {
          const auto& v = mesh_.triangles[order_[n]];
          const Vec3 d =
              p - closest_on_triangle(p, mesh_.points_mm[v[0]], mesh_.points_mm[v[1]], mesh_.points_mm[v[2]]);
          if (dot(d, d) >= best) continue;
          best = dot(d, d);
          if (triangle) *triangle = order_[n];
        }
      });
  return best;
}

}  // namespace trephine::surface
