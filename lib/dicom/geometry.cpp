// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/rank.h"
#include "dicom/elements.h"

namespace trephine::dicom {
namespace {

/// A head of 5 mm slices tilted by 25 degrees grows to twice its size, a change of spacing by at most five times.
constexpr double largest_growth = 20;

[[noreturn]] void refuse(const Message& what) {
  throw Error(ExitCode::bad_input, "", tag_name(make_tag(0x0020, 0x0032)), what).because(Cause::missing_slices);
}

std::string mm(double v) { return fmt::format("{:.3f}", v); }

double median(std::vector<double> values) { return values.empty() ? 0 : median_of(values); }

/// The indices in order along the normal. Ties are decided by the rest of the position, so that the order of the files
/// does not matter.
std::vector<int> sorted_along(const SliceStack& stack) {
  const Vec3 n = stack.normal();
  std::vector<int> order(stack.positions_mm.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    const Vec3 p = stack.positions_mm[a], q = stack.positions_mm[b];
    const double dp = dot(p, n), dq = dot(q, n);
    if (dp != dq) return dp < dq;
    return std::make_tuple(p.x, p.y, p.z) < std::make_tuple(q.x, q.y, q.z);
  });
  return order;
}

std::vector<std::vector<int>> group_levels(const SliceStack& stack) {
  const Vec3 n = stack.normal();
  std::vector<std::vector<int>> levels;
  for (const int i : sorted_along(stack)) {
    const Vec3 p = stack.positions_mm[i];
    if (!levels.empty() && dot(p - stack.positions_mm[levels.back().front()], n) < same_position_mm)
      levels.back().push_back(i);
    else
      levels.push_back({i});
  }
  return levels;
}

std::vector<double> steps_of(const std::vector<double>& along) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < along.size(); ++k) steps.push_back(along[k] - along[k - 1]);
  return steps;
}

/// Whether a step leads over missing slices: it is at least nearly twice each of its two neighbours, which are equal,
/// and at least twice the usual step around it, so that jitter is not mistaken for it. At the ends of the stack the
/// next two steps are used as the neighbours.
bool is_missing_slice(const std::vector<double>& steps, std::size_t k) {
  constexpr double factor = 1.8, equal = 0.1;
  const std::size_t n = steps.size();
  if (n < 3) return false;
  const std::size_t a = k == 0 ? 1 : k - 1, b = k == 0 ? 2 : k + 1 == n ? n - 3 : k + 1;
  const double low = std::min(steps[a], steps[b]), high = std::max(steps[a], steps[b]);
  if (high - low > equal * high || steps[k] < factor * high) return false;
  std::vector<double> around;
  for (std::size_t i = k >= 4 ? k - 4 : 0; i < std::min(n, k + 5); ++i)
    if (i != k) around.push_back(steps[i]);
  return steps[k] >= factor * median(around);
}

struct Run {
  std::size_t first = 0, count = 0;
};

/// The longest run of consecutive steps that differ from `step` by at most `tolerance`; where `step` is 0, from the
/// first step of the run.
template <class Accept>
Run longest_run(const std::vector<double>& steps, double tolerance, Accept accept) {
  Run best;
  for (std::size_t i = 0; i < steps.size();) {
    std::size_t j = i + 1;
    while (j < steps.size() && std::abs(steps[j] - steps[i]) <= tolerance) ++j;
    if (j - i > best.count && accept(steps[i])) best = {i, j - i};
    i = j;
  }
  return best;
}

/// The target's levels for uneven positions: see import.h.
void choose_levels(const std::vector<double>& along, StackGeometry& g) {
  const std::vector<double> steps = steps_of(along);
  const double length = along.back() - along.front(), usual = median(steps);
  // A real change of spacing shows as a run of equal steps. The spacing of the finer part is taken, so that no detail
  // is lost.
  double finest = usual;
  for (std::size_t k = 0; k + 1 < steps.size(); ++k) {
    const double s = std::max(steps[k], steps[k + 1]);
    if (std::abs(steps[k] - steps[k + 1]) <= std::max(0.01, 0.02 * s) && s < 0.75 * usual) finest = std::min(finest, s);
  }
  finest = std::max(finest, length / (5.0 * static_cast<double>(along.size())));

  const Run run =
      longest_run(steps, 2 * uniform_tolerance_mm, [&](double s) { return std::abs(s - finest) <= 0.05 * finest; });
  if (run.count >= 2 && 4 * run.count >= steps.size()) {
    // The levels are in phase with the regular part, whose slices then stay unchanged.
    const double anchor = along[run.first];
    const double step = (along[run.first + run.count] - anchor) / static_cast<double>(run.count);
    const double from = std::ceil((along.front() - anchor) / step - 1e-3),
                 to = std::floor((along.back() - anchor) / step + 1e-3);
    g.target_first_mm = anchor + from * step;
    g.target.spacing_mm.z = step;
    g.target.size[2] = static_cast<int>(to - from) + 1;
  } else {
    const int count = std::max(2, static_cast<int>(std::lround(length / finest)) + 1);
    g.target_first_mm = along.front();
    g.target.spacing_mm.z = length / (count - 1);
    g.target.size[2] = count;
  }
}

/// Slope of the least-squares line of y over x.
double line_slope(const std::vector<double>& x, const std::vector<double>& y) {
  const double n = static_cast<double>(x.size());
  const double mx = std::accumulate(x.begin(), x.end(), 0.0) / n, my = std::accumulate(y.begin(), y.end(), 0.0) / n;
  double xy = 0, xx = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (x[i] - mx) * (y[i] - my);
    xx += (x[i] - mx) * (x[i] - mx);
  }
  return xx > 0 ? xy / xx : 0;
}

void check_steps(const std::vector<double>& steps, GapPolicy gaps, double max_gap_mm, StackGeometry& g) {
  g.smallest_step_mm = *std::min_element(steps.begin(), steps.end());
  g.largest_step_mm = *std::max_element(steps.begin(), steps.end());
  if (g.largest_step_mm > max_gap_mm + uniform_tolerance_mm) {
    const Message what = fmt::format("a gap of {} mm between slices, max_gap_mm is {}; take another series",
                                     mm(g.largest_step_mm), max_gap_mm);
    if (g.largest_step_mm > largest_max_gap_mm) refuse(what);
    const Setting wider{"max_gap_mm", fmt::format("{:g}", std::ceil(g.largest_step_mm))};
    const auto widest = std::size_t(std::max_element(steps.begin(), steps.end()) - steps.begin());
    if (gaps == GapPolicy::interpolate || !is_missing_slice(steps, widest))
      refuse(what + ", or " + wider + " reads it");
    refuse(what + ", or " + wider + " with " + Setting{"gaps", "interpolate"} + " fills it with what was not scanned");
  }
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (!is_missing_slice(steps, k)) continue;
    ++g.missing_steps;
    if (gaps == GapPolicy::refuse)
      refuse(fmt::format("a slice is missing: a gap of {} mm above slice {} of {}, neighbours {} mm; ", mm(steps[k]),
                         k + 1, steps.size() + 1, mm(steps[k == 0 ? 1 : k - 1])) +
             Setting{"gaps", "interpolate"} + " reads it");
  }
}

}  // namespace

int count_levels(const SliceStack& stack) { return static_cast<int>(group_levels(stack).size()); }

double median_step_mm(const SliceStack& stack) {
  std::vector<double> along;
  for (const auto& level : group_levels(stack)) along.push_back(dot(stack.positions_mm[level.front()], stack.normal()));
  return median(steps_of(along));
}

StackGeometry analyse_stack(const SliceStack& stack, GapPolicy gaps, double max_gap_mm) {
  const Vec3 u = stack.u, v = stack.v, n = stack.normal();
  StackGeometry g;
  g.levels = group_levels(stack);
  if (static_cast<int>(g.levels.size()) < min_slices)
    refuse(fmt::format("{} slice position{}, at least {} are needed", g.levels.size(), g.levels.size() == 1 ? "" : "s",
                       min_slices));

  // Positions are relative to the first slice, so that large coordinates cost no digits.
  const Vec3 first = stack.positions_mm[g.levels.front().front()];
  std::vector<double> along, across_u, across_v;
  for (const auto& level : g.levels) {
    const Vec3 d = stack.positions_mm[level.front()] - first;
    along.push_back(dot(d, n));
    across_u.push_back(dot(d, u));
    across_v.push_back(dot(d, v));
    for (const int i : level) {
      const Vec3 apart = stack.positions_mm[i] - stack.positions_mm[level.front()];
      if (std::hypot(dot(apart, u), dot(apart, v)) >= same_position_mm)
        refuse(fmt::format("two slices lie side by side, {} mm apart, at one level: not one volume", mm(norm(apart))));
    }
  }
  const std::vector<double> steps = steps_of(along);
  check_steps(steps, gaps, max_gap_mm, g);

  const double tilt_u = line_slope(along, across_u), tilt_v = line_slope(along, across_v);
  const auto drift = [](const std::vector<double>& s) {
    return *std::max_element(s.begin(), s.end()) - *std::min_element(s.begin(), s.end());
  };
  const bool sheared_u = drift(across_u) > drift_tolerance_mm, sheared_v = drift(across_v) > drift_tolerance_mm;
  g.sheared = sheared_u || sheared_v;
  if (g.sheared) {
    const double angle = std::atan(std::hypot(tilt_u, tilt_v)) * 180 / M_PI;
    g.tilt_deg = (std::abs(tilt_v) >= std::abs(tilt_u) ? tilt_v : tilt_u) < 0 ? -angle : angle;
    if (angle > 45)
      refuse(fmt::format("the slices' positions run at {:.1f} degrees to their normal, at most 45 make sense", angle));
  }

  const std::size_t count = along.size();
  const double mean = along.back() / static_cast<double>(count - 1);
  bool uniform = true;
  for (std::size_t k = 0; k < count; ++k)
    if (std::abs(along[k] - static_cast<double>(k) * mean) > uniform_tolerance_mm) uniform = false;

  g.target.direction.column = {u, v, n};
  g.target.spacing_mm = {stack.dx_mm, stack.dy_mm, mean};
  g.target.size = {stack.columns, stack.rows, static_cast<int>(count)};
  if (!uniform) choose_levels(along, g);

  // The target covers every slice in its plane.
  const auto place = [](bool sheared, const std::vector<double>& across, double spacing, int& size) {
    if (!sheared) return 0.0;
    const double low = *std::min_element(across.begin(), across.end());
    const double high = *std::max_element(across.begin(), across.end());
    size += static_cast<int>(std::ceil((high - low) / spacing - 1e-6));
    return low;
  };
  const double low_u = place(sheared_u, across_u, stack.dx_mm, g.target.size[0]);
  const double low_v = place(sheared_v, across_v, stack.dy_mm, g.target.size[1]);
  for (std::size_t k = 0; k < count; ++k)
    g.shift.push_back(
        {sheared_u ? (across_u[k] - low_u) / stack.dx_mm : 0.0, sheared_v ? (across_v[k] - low_v) / stack.dy_mm : 0.0});
  const double stored = double(stack.columns) * stack.rows * static_cast<double>(count);
  const double wanted = double(g.target.size[0]) * g.target.size[1] * g.target.size[2];
  if (!(wanted <= largest_growth * stored))
    refuse(fmt::format("the upright grid that covers the slices would be {:.0f} times as large as they are, at most {}",
                       wanted / stored, largest_growth));
  g.along_mm = along;
  g.target.origin_mm = first;
  if (g.sheared || !uniform) {
    g.resampled = true;
    g.target.origin_mm = first + u * low_u + v * low_v + n * g.target_first_mm;
    if (g.sheared) g.reason = "tilt";
    if (!uniform)
      g.reason +=
          std::string(g.reason.empty() ? "" : " and ") + (g.missing_steps ? "missing slices" : "uneven spacing");
  }
  return g;
}

}  // namespace trephine::dicom
