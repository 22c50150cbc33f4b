// SPDX-License-Identifier: GPL-3.0-or-later
// The foramina of Monro: the third ventricle is the single slit below the pair of lateral ones; each foramen is the
// narrowest place of the way between them.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>

#include "base/parallel.h"
#include "head/landmarks_parts.h"
#include "mask/filters.h"
#include "mask/hu_view.h"
#include "surface/bounds.h"

namespace trephine::head {
namespace {

constexpr double step_mm = 0.7, half_width_mm = 22;
constexpr double max_outside_mm = 3;  ///< walls of twice that are crossed where the foramen was not resolved
/// A foramen of this radius is seen in any noise; its narrowest part is so short, and hardly as long as the longest.
constexpr double wide_mm = 1.3, short_mm = 4, longest_mm = 16;
constexpr double least_third_mm = 10, sure_third_mm = 18;  ///< of the third ventricle, which is 25 to 40 mm long
/// What the scan itself shows of a foramen is smoothed, and fluid and tissue in it have to be this far apart.
constexpr double smooth_mm = 1, min_contrast_hu = 8;

/// Signed distance to the ventricles' surface, positive inside, on a raster along the head's axes: x to the left, y to
/// the back, z up.
struct Local {
  grid::Grid<float> distance;
  HeadFrame head;
  Vec3 corner_mm;  ///< voxel (0, 0, 0) in the head's coordinates
  Vec3 in_head(int i, int j, int k) const { return corner_mm + Vec3{double(i), double(j), double(k)} * step_mm; }
  Vec3 to_world(Vec3 p) const { return head.origin_mm + head.left * p.x + head.back * p.y + head.up * p.z; }
};

Local local_distance(const craniometry::FieldView& view, const HeadFrame& head) {
  const grid::Lattice& l = view.field();
  Vec3 low{1e30, 1e30, 1e30}, high = -low;
  for (const Vec3 corner : surface::corners_of(l)) {
    const Vec3 d = corner - head.origin_mm;
    const Vec3 p{dot(d, head.left), dot(d, head.back), dot(d, head.up)};
    for (int a = 0; a < 3; ++a) low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
  }
  low.x = std::max(low.x, -half_width_mm), high.x = std::min(high.x, half_width_mm);
  Local out;
  out.head = head;
  out.corner_mm = low;
  grid::Field f;
  f.spacing_mm = {step_mm, step_mm, step_mm};
  for (int a = 0; a < 3; ++a) f.size[a] = int(std::clamp((high[a] - low[a]) / step_mm, 0.0, 400.0)) + 2;
  f.voxels.resize(f.count());
  parallel_for(0, f.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < f.size[1]; ++j)
        for (int i = 0; i < f.size[0]; ++i) f.at(i, j, k) = float(view(out.to_world(out.in_head(i, j, k))));
  });
  out.distance = craniometry::near_distance_mm(f, 9);
  return out;
}

/// How dark the scan is at each voxel of the raster, smoothed: 0 as tissue beside the ventricles, 1 as they are.
/// Empty where the two are hardly apart.
grid::Grid<float> darkness(const Local& local, const grid::HuVolume& volume) {
  const mask::HuView hu(volume);
  const grid::Lattice& l = hu.lattice();
  const grid::Grid<float>& d = local.distance;
  Vec3 low{1e30, 1e30, 1e30}, high = -low;
  for (int corner = 0; corner < 8; ++corner) {
    const auto at = [&](int axis) { return corner >> axis & 1 ? d.size[axis] - 1 : 0; };
    const Vec3 p = l.to_index(local.to_world(local.in_head(at(0), at(1), at(2))));
    for (int a = 0; a < 3; ++a) low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
  }
  grid::Box box;
  for (int a = 0; a < 3; ++a) {
    const int margin = int(std::ceil(3 * smooth_mm / l.spacing_mm[a]));
    box.begin[a] = std::clamp(int(std::floor(low[a])) - margin, 0, l.size[a] - 1);
    box.end[a] = std::clamp(int(std::ceil(high[a])) + margin + 1, box.begin[a] + 1, l.size[a]);
  }
  grid::Field smooth = mask::crop(hu, box);
  for (float& v : smooth.voxels) v = std::clamp(v, -20.f, 60.f);  // calcified plexus must not hide what is beside it
  mask::gaussian(smooth, smooth_mm);
  const craniometry::FieldView view(smooth, l);
  grid::Grid<float> out(d);
  parallel_for(0, d.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < d.size[1]; ++j)
        for (int i = 0; i < d.size[0]; ++i) out.at(i, j, k) = float(view(local.to_world(local.in_head(i, j, k))));
  });
  std::vector<float> fluid, tissue;
  for (std::size_t v = 0; v < d.voxels.size(); ++v)
    if (d.voxels[v] > 1.2f)
      fluid.push_back(out.voxels[v]);
    else if (d.voxels[v] < -2.5f && d.voxels[v] > -5)
      tissue.push_back(out.voxels[v]);
  const float dark = mask::median(fluid, 0), bright = mask::median(tissue, 0);
  if (bright - dark < min_contrast_hu) return {};
  for (float& v : out.voxels) v = std::clamp((bright - v) / (bright - dark), 0.f, 1.f);
  return out;
}

struct Interval {
  int begin, end;
  double width_mm() const { return (end - begin) * step_mm; }
  double middle() const { return 0.5 * (begin + end - 1); }
};

/// Where the ventricles lie along a row from right to left.
std::vector<Interval> intervals(const grid::Grid<float>& d, int j, int k) {
  std::vector<Interval> out;
  for (int i = 0; i < d.size[0]; ++i) {
    if (!(d.at(i, j, k) > 0)) continue;
    if (!out.empty() && out.back().end == i)
      out.back().end = i + 1;
    else
      out.push_back({i, i + 1});
  }
  return out;
}

/// The middle between the lateral ventricles (they may be displaced from the midline): the middle of the septum.
std::optional<double> septum_column(const grid::Grid<float>& d) {
  std::vector<float> middles;
  for (int k = 0; k < d.size[2]; ++k)
    for (int j = 0; j < d.size[1]; ++j) {
      const auto found = intervals(d, j, k);
      if (found.size() != 2 || found[0].width_mm() < 2 || found[1].width_mm() < 2) continue;
      if ((found[1].begin - found[0].end) * step_mm > 8) continue;
      middles.push_back(float(0.5 * (found[0].end + found[1].begin - 1)));
    }
  if (middles.size() < 60) return {};
  return mask::median(middles, 0);
}

/// The third ventricle's rows: a single interval about the middle, under rows of a pair. One flag a (j, k).
struct Third {
  std::vector<char> row;
  int front = 0, back = 0, bottom = 0, top = 0;  ///< bounds in j and k
  std::size_t rows = 0;
};
Third third_ventricle(const grid::Grid<float>& d, double column) {
  const int nj = d.size[1], nk = d.size[2];
  std::vector<char> single(std::size_t(nj) * nk, 0), pair(single);
  for (int k = 0; k < nk; ++k)
    for (int j = 0; j < nj; ++j) {
      std::vector<Interval> near;
      for (const Interval& i : intervals(d, j, k))
        if (std::abs(i.middle() - column) * step_mm < 18) near.push_back(i);
      bool left = false, right = false;
      int middle = 0;
      for (const Interval& i : near) {
        const double off_mm = (i.middle() - column) * step_mm;
        if (std::abs(off_mm) < 2.5 && i.width_mm() < 14) ++middle;
        left = left || off_mm > 2.5;
        right = right || off_mm < -2.5;
      }
      single[std::size_t(k) * nj + j] = middle == 1 && !left && !right;
      pair[std::size_t(k) * nj + j] = left && right;
    }
  // Below a pair, within 30 mm.
  for (int j = 0; j < nj; ++j) {
    int last_pair = nk + 1000;
    for (int k = nk - 1; k >= 0; --k) {
      if (pair[std::size_t(k) * nj + j]) last_pair = k;
      if ((last_pair - k) * step_mm > 30 || last_pair > nk) single[std::size_t(k) * nj + j] = 0;
    }
  }
  Third best;
  std::vector<char> seen(single.size(), 0);
  for (int k0 = 0; k0 < nk; ++k0)
    for (int j0 = 0; j0 < nj; ++j0) {
      if (!single[std::size_t(k0) * nj + j0] || seen[std::size_t(k0) * nj + j0]) continue;
      Third t;
      t.row.assign(single.size(), 0);
      t.front = t.back = j0, t.bottom = t.top = k0;
      std::vector<std::array<int, 2>> stack{{j0, k0}};
      seen[std::size_t(k0) * nj + j0] = 1;
      while (!stack.empty()) {
        const auto [j, k] = stack.back();
        stack.pop_back();
        t.row[std::size_t(k) * nj + j] = 1;
        ++t.rows;
        t.front = std::min(t.front, j), t.back = std::max(t.back, j);
        t.bottom = std::min(t.bottom, k), t.top = std::max(t.top, k);
        for (const auto& [dj, dk] : {std::array<int, 2>{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
          const int a = j + dj, b = k + dk;
          if (a < 0 || b < 0 || a >= nj || b >= nk || !single[std::size_t(b) * nj + a]) continue;
          if (seen[std::size_t(b) * nj + a]++) continue;
          stack.push_back({a, b});
        }
      }
      if (t.rows > best.rows) best = std::move(t);
    }
  return best;
}

/// The cheapest way from `seeds` to a voxel of `ends`, costly where `room` (above 0) is small; empty where there is
/// none.
std::vector<std::size_t> way(const grid::Grid<float>& d, const std::vector<char>& seeds, const std::vector<char>& ends,
                             const std::vector<char>& allowed, const std::function<double(std::size_t)>& room_at) {
  const std::array<std::array<int, 3>, 6> next{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
  std::vector<float> cost(d.count(), std::numeric_limits<float>::infinity());
  std::vector<std::int32_t> before(d.count(), -1);
  using Item = std::pair<float, std::size_t>;
  std::priority_queue<Item, std::vector<Item>, std::greater<Item>> queue;
  for (std::size_t v = 0; v < seeds.size(); ++v)
    if (seeds[v]) cost[v] = 0, queue.push({0.f, v});
  while (!queue.empty()) {
    const auto [c, v] = queue.top();
    queue.pop();
    if (c > cost[v]) continue;
    if (ends[v]) {
      std::vector<std::size_t> path;
      for (std::int64_t p = std::int64_t(v); p >= 0; p = before[p]) path.push_back(std::size_t(p));
      return path;
    }
    const int i = int(v % d.size[0]), j = int(v / d.size[0] % d.size[1]), k = int(v / d.size[0] / d.size[1]);
    for (const auto& n : next) {
      if (!d.contains(i + n[0], j + n[1], k + n[2])) continue;
      const std::size_t w = d.index(i + n[0], j + n[1], k + n[2]);
      if (!allowed[w]) continue;
      const double room = room_at(w);
      const float there = c + float(1 / (room * room * room));
      if (there < cost[w]) cost[w] = there, before[w] = std::int32_t(v), queue.push({there, w});
    }
  }
  return {};
}

/// The foramina mirror each other about the septum (at `septum_mm` to the left): the less two of them do, the less sure
/// both are, and a missing or doubtful one is taken from a sure one.
void check_pair(std::array<std::optional<FoundPoint>, 2>& found, const HeadFrame& head, double septum_mm) {
  const auto mirrored = [&](Vec3 p) { return p - head.left * (2 * (dot(p - head.origin_mm, head.left) - septum_mm)); };
  constexpr double min_apart_mm = 1, doubtful_apart_mm = 2, max_apart_mm = 4, of_a_mirrored = 0.5;
  const double apart_mm = found[0] && found[1] ? norm(mirrored(found[0]->position_mm) - found[1]->position_mm) : 1e9;
  for (int s = 0; s < 2; ++s) {
    auto &here = found[s], &there = found[1 - s];
    if (!there || there->confidence <= 0.6 || (here && here->confidence >= 0.6)) continue;
    const double least = of_a_mirrored * there->confidence;
    if (apart_mm > doubtful_apart_mm)
      here = FoundPoint{mirrored(there->position_mm), least};
    else  // two that agree: the sure one speaks for the other
      here->confidence = std::max(here->confidence, least);
    return;
  }
  if (apart_mm < max_apart_mm) {
    // Two that are 4 mm apart are off by 2 mm each at least.
    for (auto& p : found)
      p->confidence = std::min(p->confidence, 0.5 + 0.5 * mask::ramp(apart_mm, max_apart_mm, min_apart_mm));
    return;
  }
  for (auto& p : found)
    if (p) p->confidence *= 0.5;
}

/// The brightest place of a way through the dark: the middle of what is hardly darker. None where it is as bright as
/// what a wall of 2.5 mm between two ventricles looks like.
std::optional<Vec3> brightest_place(const Local& local, const grid::Grid<float>& dark,
                                    const std::vector<std::size_t>& path) {
  constexpr float min_dark = 0.3f, hardly_darker = 0.12f;
  if (path.size() < 3) return {};
  const auto at = [&](std::size_t i) { return dark.voxels[path[i]]; };
  std::size_t narrow = 0;
  for (std::size_t i = 1; i < path.size(); ++i)
    if (at(i) < at(narrow)) narrow = i;
  if (at(narrow) < min_dark) return {};
  std::size_t from = narrow, to = narrow;
  while (from > 0 && at(from - 1) < at(narrow) + hardly_darker) --from;
  while (to + 1 < path.size() && at(to + 1) < at(narrow) + hardly_darker) ++to;
  Vec3 sum;
  for (std::size_t i = from; i <= to; ++i) {
    const std::size_t v = path[i];
    sum += local.in_head(int(v % dark.size[0]), int(v / dark.size[0] % dark.size[1]),
                         int(v / dark.size[0] / dark.size[1]));
  }
  return local.to_world(sum / double(to - from + 1));
}

/// The segmentation moves a foramen by a millimetre or two, and so does noise in the scan: their middle is nearer to it
/// than either. Where the two are far apart, the first stays and is half as sure.
void meet(FoundPoint& p, const std::optional<Vec3>& seen) {
  constexpr double max_apart_mm = 5;
  if (!seen) return;
  if (norm(*seen - p.position_mm) > max_apart_mm)
    p.confidence *= 0.5;
  else
    p.position_mm = (p.position_mm + *seen) * 0.5;
}

/// Where the passage runs between two places of the way: their middle, moved into the middle of the passage's cross
/// section, for the way itself has corners.
Vec3 middle_of_passage(const Local& local, const std::vector<std::size_t>& path, std::size_t from, std::size_t to,
                       double septum_mm, int side) {
  const grid::Grid<float>& d = local.distance;
  const auto at = [&](std::size_t i) {
    const std::size_t v = path[i];
    return local.in_head(int(v % d.size[0]), int(v / d.size[0] % d.size[1]), int(v / d.size[0] / d.size[1]));
  };
  Vec3 sum;
  for (std::size_t i = from; i <= to; ++i) sum += at(i);
  Vec3 middle = sum / double(to - from + 1);
  const std::size_t around = std::size_t(5 / step_mm);
  const Vec3 along = normalized(at(std::min(path.size() - 1, to + around)) - at(from > around ? from - around : 0));
  constexpr double reach_mm = 3;
  for (int pass = 0; pass < 3; ++pass) {
    Vec3 moved;
    double weights = 0;
    const Vec3 c = (middle - local.corner_mm) / step_mm;
    const int r = int(std::ceil(reach_mm / step_mm));
    for (int k = int(c.z) - r; k <= int(c.z) + r + 1; ++k)
      for (int j = int(c.y) - r; j <= int(c.y) + r + 1; ++j)
        for (int i = int(c.x) - r; i <= int(c.x) + r + 1; ++i) {
          if (!d.contains(i, j, k) || d.at(i, j, k) <= 0) continue;
          // The other side's foramen opens beside it.
          if ((local.in_head(i, j, k).x - septum_mm) * side < 0) continue;
          Vec3 off = local.in_head(i, j, k) - middle;
          if (norm(off) > reach_mm || std::abs(dot(off, along)) > 0.8) continue;
          off = off - along * dot(off, along);
          const double w = d.at(i, j, k);
          moved += off * w;
          weights += w;
        }
    if (!(weights > 0)) break;
    middle += moved / weights;
  }
  return middle;
}

}  // namespace

std::array<std::optional<FoundPoint>, 2> find_monro(const craniometry::FieldView& ventricles,
                                                    const grid::HuVolume& volume, const HeadFrame& head) {
  const Local local = local_distance(ventricles, head);
  const grid::Grid<float> dark = darkness(local, volume);
  const grid::Grid<float>& d = local.distance;
  const auto column = septum_column(d);
  if (!column) return {};
  const Third third = third_ventricle(d, *column);
  const double length = (third.back - third.front) * step_mm;
  // The foramina lie at the front end of its roof. A short piece may be the lateral ones' floor, where these meet.
  if (third.rows * step_mm * step_mm < 25 || length < least_third_mm) return {};
  const int last_j = third.front + int((0.4 * length + 2) / step_mm), first_j = third.front - int(5 / step_mm),
            level = (third.bottom + third.top) / 2;
  std::array<std::optional<FoundPoint>, 2> found;
  for (int s = 0; s < 2; ++s) {
    const int side = s == 0 ? 1 : -1;
    std::vector<char> seeds(d.count(), 0), ends(d.count(), 0), allowed(d.count(), 0);
    for (int k = level; k < d.size[2]; ++k)
      for (int j = std::max(0, first_j); j <= std::min(last_j, d.size[1] - 1); ++j)
        for (int i = 0; i < d.size[0]; ++i) {
          const std::size_t v = d.index(i, j, k);
          const double off_mm = (i - *column) * step_mm * side, in_mm = d.voxels[v];
          // Not over the other side's foramen and through the septum.
          if (!(in_mm > -max_outside_mm) || off_mm < (k > third.top ? 0 : -2)) continue;
          allowed[v] = 1;
          seeds[v] = in_mm > 0 && third.row[std::size_t(k) * d.size[1] + j] && k < third.top - int(2 / step_mm);
          ends[v] = in_mm > 1 && off_mm > 3 && k > third.top + int(1.5 / step_mm);
        }
    // From the third ventricle's core to that of the lateral one: beside a wall all is narrow.
    float third_mm = 0, lateral_mm = 0;
    for (std::size_t v = 0; v < ends.size(); ++v) {
      if (seeds[v]) third_mm = std::max(third_mm, d.voxels[v]);
      if (ends[v]) lateral_mm = std::max(lateral_mm, d.voxels[v]);
    }
    for (std::size_t v = 0; v < ends.size(); ++v) {
      if (d.voxels[v] < 0.7f * third_mm) seeds[v] = 0;
      if (d.voxels[v] < 0.7f * lateral_mm) ends[v] = 0;
    }
    const auto path =
        way(d, seeds, ends, allowed, [&](std::size_t v) { return double(d.voxels[v]) + max_outside_mm + 0.3; });
    if (path.size() < 3) continue;
    std::size_t narrow = 0;
    for (std::size_t i = 1; i < path.size(); ++i)
      if (d.voxels[path[i]] < d.voxels[path[narrow]]) narrow = i;
    // A foramen is a short passage: the middle of all that is hardly wider.
    std::size_t from = narrow, to = narrow;
    const float limit = d.voxels[path[narrow]] + 0.4f;
    while (from > 0 && d.voxels[path[from - 1]] < limit) --from;
    while (to + 1 < path.size() && d.voxels[path[to + 1]] < limit) ++to;
    FoundPoint p;
    p.position_mm =
        local.to_world(middle_of_passage(local, path, from, to, local.corner_mm.x + *column * step_mm, side));
    // Wide: sure. A narrow one may be a gap that noise made or moved, a long one has no narrowest place; where a wall
    // was crossed, the less the thicker it is.
    const double radius_mm = d.voxels[path[narrow]];
    p.confidence = radius_mm > 0 ? std::min(0.8 + 0.2 * mask::ramp(radius_mm, 0, wide_mm),
                                            mask::ramp(double(to - from) * step_mm, longest_mm, short_mm))
                                 : mask::ramp(radius_mm, -max_outside_mm, 0) * 0.8;
    p.confidence *= mask::ramp(length, least_third_mm, sure_third_mm);
    if (!dark.voxels.empty())
      meet(p, brightest_place(local, dark, way(d, seeds, ends, allowed, [&](std::size_t v) {
                                return double(dark.voxels[v]) + 0.1;
                              })));
    found[s] = p;
  }
  check_pair(found, head, local.corner_mm.x + *column * step_mm);
  return found;
}

}  // namespace trephine::head
