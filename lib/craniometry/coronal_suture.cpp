// SPDX-License-Identifier: GPL-3.0-or-later
#include "craniometry/coronal_suture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "base/parallel.h"
#include "mask/filters.h"
#include "mask/hu_view.h"

namespace trephine::craniometry {
namespace {

using mask::HuView;

constexpr int half_planes = 40, planes = 2 * half_planes + 1;  ///< 1 mm apart
constexpr double first_deg = 40, last_deg = 150, turn_deg = 0.25;
constexpr int columns = int((last_deg - first_deg) / turn_deg) + 1;
constexpr double reach_mm = 160;  ///< bone farther from the centre is not seen
/// The depth at which the bone is looked at: the outer table, and the vault's thickness, in which a suture that has
/// grown together in the table may still show.
struct Depth {
  double from_mm, to_mm;
};
constexpr Depth outer_table{1, 3}, whole_vault{0.5, 6.5};
constexpr double min_visible_ratio = 0.3;  ///< of the outer table: from here on it says where the suture lies
constexpr double agreeing_mm = 8, of_a_contradicted_one = 0.4, of_the_vault_alone = 0.6;
constexpr double min_arc_mm = 85, max_arc_mm = 175;         ///< over the bone, from the nasion's level
constexpr double cleft_beside_mm = 3, ridge_beside_mm = 8;  ///< where the bone is that a line is compared with
constexpr double max_cleft = 0.3, max_ridge = 0.25;         ///< a burr hole is not worth more than a suture
constexpr double full_contrast = 0.1, seen_strength = 0.8;  ///< in units of full_contrast
constexpr double other_line_mm = 8, max_halves_apart_mm = 10, beside_midline_mm = 8, near_midline_mm = 12;
constexpr double full_strength = 0.6;  ///< what is stronger counts no more: a clear part far from the midline says less
constexpr double ring_step = 0.1;      ///< of a slice
constexpr int max_step = 2;            ///< columns from plane to plane
constexpr double step_cost = 0.05;

/// Trilinear; air outside.
double hu_at(const HuView& hu, Vec3 world) {
  const grid::Lattice& l = hu.lattice();
  const Vec3 p = l.to_index(world);
  int low[3];
  double t[3];
  for (int a = 0; a < 3; ++a) {
    if (!(p[a] >= 0 && p[a] <= l.size[a] - 1)) return -1024;
    low[a] = std::min(int(p[a]), std::max(0, l.size[a] - 2));
    t[a] = p[a] - low[a];
  }
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    int at[3];
    double w = 1;
    for (int a = 0; a < 3; ++a) {
      const int s = c >> a & 1;
      at[a] = std::min(low[a] + s, l.size[a] - 1);
      w *= s ? t[a] : 1 - t[a];
    }
    if (w > 0) sum += w * hu(at[0], at[1], at[2]);
  }
  return sum;
}

/// The outer table unrolled: x along a plane from front to back, y from plane to plane, to the left.
struct Unrolled {
  std::vector<Vec3> table_mm;
  std::vector<char> known;
  grid::Grid<float> density;  ///< HU of the table
  double column_mm = 0;

  std::size_t at(int row, int column) const { return std::size_t(row) * columns + column; }
};

Unrolled unroll(const HuView& hu, const CalvariaFrame& f, const BoneRay& bone, Depth looked_at) {
  Unrolled u;
  u.table_mm.resize(std::size_t(planes) * columns);
  u.known.assign(u.table_mm.size(), 0);
  grid::Lattice l;
  l.size = {columns, planes, 1};
  u.density = grid::Grid<float>(l, 0.f);
  parallel_for(0, planes, 1, [&](std::int64_t from, std::int64_t to) {
    for (int row = int(from); row < to; ++row)
      for (int c = 0; c < columns; ++c) {
        const double angle = (first_deg + c * turn_deg) * std::acos(-1.0) / 180;
        const Vec3 out = f.front * std::cos(angle) + f.up * std::sin(angle);
        const auto met = bone(f.centre_mm + f.left * double(row - half_planes) + out * reach_mm, -out, reach_mm - 40);
        if (!met) continue;
        double sum = 0;
        int n = 0;
        for (double depth = looked_at.from_mm; depth <= looked_at.to_mm + 0.01; depth += 0.5, ++n)
          sum += hu_at(hu, *met - out * depth);
        u.table_mm[u.at(row, c)] = *met;
        u.known[u.at(row, c)] = 1;
        u.density.voxels[u.at(row, c)] = float(std::clamp(sum / n, 0.0, 3000.0));
      }
  });
  std::vector<float> radii;
  for (int c = 0; c < columns; ++c)
    if (u.known[u.at(half_planes, c)]) radii.push_back(float(norm(u.table_mm[u.at(half_planes, c)] - f.centre_mm)));
  u.column_mm = turn_deg * std::acos(-1.0) / 180 * mask::median(radii, 100);
  u.density.spacing_mm = {u.column_mm, 1, 1};
  return u;
}

/// How much denser the table is than the bone around, as a share of that.
grid::Grid<float> contrast_of(const Unrolled& u) {
  grid::Grid<float> around = u.density, out = u.density;
  mask::gaussian(around, 10);
  for (std::size_t v = 0; v < out.voxels.size(); ++v)
    out.voxels[v] = std::clamp(out.voxels[v] / std::max(around.voxels[v], 300.f) - 1, -0.6f, 0.6f);
  return out;
}

/// Thick slices leave rings of alternating density where a vault crosses them: the median of all that lies at the same
/// place between two slices is taken off, before the highest slice and behind it.
void take_rings_off(grid::Grid<float>& contrast, const Unrolled& u, const grid::Lattice& scan) {
  std::vector<double> slice(u.table_mm.size(), 0);
  int top = 0;
  double highest = -1e9;
  for (int c = 0; c < columns; ++c) {
    double sum = 0;
    int n = 0;
    for (int row = 0; row < planes; ++row)
      if (u.known[u.at(row, c)]) sum += slice[u.at(row, c)] = scan.to_index(u.table_mm[u.at(row, c)]).z, ++n;
    if (n && sum / n > highest) highest = sum / n, top = c;
  }
  for (const bool front : {true, false}) {
    std::map<long, std::vector<std::size_t>> rings;
    for (int row = 0; row < planes; ++row)
      for (int c = front ? 0 : top; c < (front ? top : columns); ++c)
        if (u.known[u.at(row, c)]) rings[std::lround(slice[u.at(row, c)] / ring_step)].push_back(u.at(row, c));
    for (const auto& [number, members] : rings) {
      if (members.size() < 20) continue;
      std::vector<float> values;
      for (const std::size_t m : members) values.push_back(contrast.voxels[m]);
      const float middle = mask::median(values, 0);
      for (const std::size_t m : members) contrast.voxels[m] -= middle;
    }
  }
}

/// Smoothed along the planes by `along_mm` and across them by `across_mm`.
grid::Grid<float> smooth(grid::Grid<float> g, double across_mm, double along_mm) {
  const double column_mm = g.spacing_mm.x;
  g.spacing_mm = {column_mm / along_mm, 1 / across_mm, 1};
  mask::gaussian(g, 1);
  g.spacing_mm = {column_mm, 1, 1};
  return g;
}

/// How much each place looks like one of a suture that runs from side to side, in units of full_contrast.
grid::Grid<float> strength_of(const grid::Grid<float>& contrast) {
  const grid::Grid<float> fine = smooth(contrast, 1, 0.5), coarse = smooth(contrast, 2, 2);
  grid::Grid<float> out(contrast, 0.f);
  const int near = int(std::lround(cleft_beside_mm / contrast.spacing_mm.x)),
            far = int(std::lround(ridge_beside_mm / contrast.spacing_mm.x));
  for (int row = 0; row < planes; ++row)
    for (int c = far; c + far < columns; ++c) {
      const double cleft = double(std::min(fine.at(c - near, row, 0), fine.at(c + near, row, 0))) - fine.at(c, row, 0);
      const double ridge =
          double(coarse.at(c, row, 0)) - std::max(coarse.at(c - far, row, 0), coarse.at(c + far, row, 0));
      out.at(c, row, 0) =
          float((std::clamp(cleft, 0.0, max_cleft) + std::clamp(ridge, 0.0, max_ridge)) / full_contrast);
    }
  return out;
}

/// The line from side to side along which the strength is greatest: a column for each plane, and the mean strength.
struct Line {
  std::vector<int> column;
  double strength = 0;
};
Line best_line(const grid::Grid<float>& strength) {
  std::vector<float> sum(strength.voxels.begin(), strength.voxels.begin() + columns);
  std::vector<signed char> from(std::size_t(planes) * columns, 0);
  for (int row = 1; row < planes; ++row) {
    std::vector<float> next(columns, -std::numeric_limits<float>::infinity());
    for (int c = 0; c < columns; ++c) {
      // Straight on first, so that of equal ways the straight one is taken.
      for (const int d : {0, 1, -1, 2, -2}) {
        if (std::abs(d) > max_step || c - d < 0 || c - d >= columns) continue;
        const float value = sum[std::size_t(c - d)] - float(step_cost * std::abs(d));
        if (value > next[c]) next[c] = value, from[std::size_t(row) * columns + c] = static_cast<signed char>(d);
      }
      next[c] += strength.at(c, row, 0);
    }
    sum = std::move(next);
  }
  Line line;
  line.column.resize(planes);
  const auto best = std::max_element(sum.begin(), sum.end());
  line.strength = *best / planes;
  int c = int(best - sum.begin());
  for (int row = planes - 1; row >= 0; --row) {
    line.column[std::size_t(row)] = c;
    c -= from[std::size_t(row) * columns + c];
  }
  return line;
}

/// Where a straight line through the suture crosses the midline, in columns times `unit`; `weight_of(to_left,
/// strength)` says how much each plane's place counts.
template <class Weight>
double crossing_of(const Line& line, const grid::Grid<float>& strength, double unit, const Weight& weight_of) {
  double w = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (int row = 0; row < planes; ++row) {
    const double to_left = row - half_planes;
    const int c = line.column[std::size_t(row)];
    const double weight = weight_of(to_left, double(strength.at(c, row, 0))), at = c * unit;
    w += weight, x += weight * to_left, y += weight * at;
    xx += weight * to_left * to_left, xy += weight * to_left * at;
  }
  const double slope = (w * xy - x * y) / (w * xx - x * x);
  return (y - slope * x) / w;
}

/// That of one half of the suture, in mm along the midline; what is seen clearly counts most.
double crossing_mm(const Line& line, const grid::Grid<float>& strength, bool left) {
  return crossing_of(line, strength, strength.spacing_mm.x, [&](double to_left, double seen) {
    return (left ? to_left : -to_left) < beside_midline_mm ? 0.0 : std::clamp(seen, 0.01, 3.0);
  });
}

/// That of its parts near the midline, as a column. Often the suture has grown together at the midline, and the way
/// between its seen parts is then any way.
int crossing_column(const Line& line, const grid::Grid<float>& strength) {
  const double column = crossing_of(line, strength, 1, [](double to_left, double strong) {
    const double near = to_left / near_midline_mm, seen = std::clamp(strong, 0.05, full_strength);
    return seen * seen * std::exp(-0.5 * near * near);
  });
  return std::clamp(int(std::lround(column)), 0, columns - 1);
}

/// Lengths over the bone of the midline from the nasion's level; -1 where there is no bone.
std::vector<double> arcs_of(const Unrolled& u, Vec3 nasion) {
  std::vector<double> arc(columns, -1);
  double length = 0;
  const Vec3* before = nullptr;
  for (int c = 0; c < columns; ++c) {
    if (!u.known[u.at(half_planes, c)]) continue;
    const Vec3& p = u.table_mm[u.at(half_planes, c)];
    length += before ? norm(p - *before) : 1.03 * norm(p - nasion);  // the arc is a little longer than its chord
    arc[c] = length;
    before = &p;
  }
  return arc;
}

std::optional<CoronalSuture> suture_in(const grid::HuVolume& volume, const CalvariaFrame& frame, const BoneRay& bone,
                                       Depth looked_at) {
  const Unrolled u = unroll(HuView(volume), frame, bone, looked_at);
  const std::vector<double> arc = arcs_of(u, frame.nasion_mm);
  grid::Grid<float> contrast = contrast_of(u);
  take_rings_off(contrast, u, grid::lattice_of(volume));
  grid::Grid<float> strength = strength_of(contrast);
  int searched = 0;
  for (int c = 0; c < columns; ++c) {
    const bool wanted = arc[c] >= min_arc_mm && arc[c] <= max_arc_mm;
    searched += wanted;
    for (int row = 0; row < planes; ++row)
      if (!wanted || !u.known[u.at(row, c)]) strength.at(c, row, 0) = 0;
  }
  if (searched * u.column_mm < 30) return {};
  const Line line = best_line(strength);
  grid::Grid<float> rest = strength;
  const int near = int(other_line_mm / u.column_mm);
  int seen = 0, seen_near = 0, near_planes = 0;
  for (int row = 0; row < planes; ++row) {
    const int c = line.column[std::size_t(row)];
    const bool is_near = std::abs(row - half_planes) <= near_midline_mm;
    seen += strength.at(c, row, 0) > seen_strength;
    seen_near += is_near && strength.at(c, row, 0) > seen_strength;
    near_planes += is_near;
    for (int k = std::max(0, c - near); k <= std::min(columns - 1, c + near); ++k) rest.at(k, row, 0) = 0;
  }
  const int crossing = crossing_column(line, strength);
  if (arc[crossing] < 0) return {};
  CoronalSuture out;
  out.bregma_mm = u.table_mm[u.at(half_planes, crossing)];
  out.arc_mm = arc[crossing];
  out.visible_ratio = double(seen) / planes;
  out.near_midline_ratio = double(seen_near) / near_planes;
  out.distinct_ratio = line.strength / std::max(best_line(rest).strength, 0.05);
  out.halves_apart_mm = std::abs(crossing_mm(line, strength, true) - crossing_mm(line, strength, false));
  out.confidence = std::min(mask::ramp(out.visible_ratio, 0.4, 0.7), mask::ramp(out.distinct_ratio, 1.2, 2));
  if (out.halves_apart_mm > max_halves_apart_mm) out.confidence *= 0.4;
  return out;
}

}  // namespace

std::optional<CoronalSuture> find_coronal_suture(const grid::HuVolume& volume, const CalvariaFrame& frame,
                                                 const BoneRay& bone) {
  auto table = suture_in(volume, frame, bone, outer_table), vault = suture_in(volume, frame, bone, whole_vault);
  if (!table || !vault) return table ? table : vault;
  CoronalSuture& clear = vault->confidence > table->confidence ? *vault : *table;
  const CoronalSuture& other = &clear == &*vault ? *table : *vault;
  if (norm(clear.bregma_mm - other.bregma_mm) <= agreeing_mm) {
    // A suture runs obliquely through the vault, and the bregma lies on the outer table.
    if (table->visible_ratio >= min_visible_ratio) {
      clear.bregma_mm = table->bregma_mm, clear.arc_mm = table->arc_mm;
      clear.near_midline_ratio = table->near_midline_ratio;
    }
    return clear;
  }
  // Two clear lines at different places: one of them is no suture, and which is not known. One that the outer table
  // does not show is less sure.
  if (other.confidence >= 0.5)
    clear.confidence *= of_a_contradicted_one;
  else if (&clear == &*vault)
    clear.confidence = std::min(clear.confidence, of_the_vault_alone);
  return clear;
}

}  // namespace trephine::craniometry
