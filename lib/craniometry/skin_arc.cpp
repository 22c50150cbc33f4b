// SPDX-License-Identifier: GPL-3.0-or-later
#include "craniometry/skin_arc.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/pi.h"
#include "grid/sample.h"

namespace trephine::craniometry {
namespace {

constexpr double step_deg = 0.1;

}  // namespace

FieldView::FieldView(const grid::Field& field, const grid::Lattice& volume) : field_(field), volume_(volume) {}

double FieldView::at_index(Vec3 p) const { return grid::sampled(field_, p, grid::value_beyond(-1)); }

std::optional<Vec3> FieldView::enter(Vec3 from, Vec3 direction, double length, double step) const {
  const Vec3 start = field_.to_index(from), rate = field_.to_index(from + direction) - start;
  bool outside = at_index(start) <= 0;
  for (double t = step; t <= length; t += step) {
    const bool inside = at_index(start + rate * t) > 0;
    if (inside && outside) {
      double low = t - step, high = t;
      while (high - low > 1e-3) {
        const double middle = 0.5 * (low + high);
        (at_index(start + rate * middle) > 0 ? high : low) = middle;
      }
      return from + direction * (0.5 * (low + high));
    }
    outside = !inside;
  }
  return {};
}

double FieldView::depth_in_scan_mm(Vec3 world) const {
  const Vec3 p = volume_.to_index(world);
  double depth = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
    depth = std::min({depth, p[a] * volume_.spacing_mm[a], (volume_.size[a] - 1 - p[a]) * volume_.spacing_mm[a]});
  return depth;
}

Outline outline(const FieldView& view, const Sweep& sweep) {
  const int first = -int(std::lround(sweep.before_deg / step_deg));
  const int count = int(std::lround((sweep.before_deg + sweep.after_deg) / step_deg)) + 1;
  std::vector<std::optional<Vec3>> met(count);
  parallel_for(0, count, 100, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      const double angle = (first + double(i)) * step_deg * pi / 180;
      const Vec3 ray = sweep.from * std::cos(angle) + sweep.onwards * std::sin(angle);
      met[i] = view.enter(sweep.centre_mm + ray * sweep.reach_mm, -ray, sweep.reach_mm);
    }
  });
  Outline out;
  for (int i = 0; i < count; ++i) {
    if (i == -first) out.start = out.points_mm.size();
    if (met[i]) out.points_mm.push_back(*met[i]);
  }
  return out;
}

std::vector<Vec3> evenly_spaced(const std::vector<Vec3>& points, double step, double sigma) {
  std::vector<Vec3> even;
  double next = 0, walked = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double piece = norm(points[i + 1] - points[i]);
    for (; next <= walked + piece && piece > 0; next += step)
      even.push_back(points[i] + (points[i + 1] - points[i]) * ((next - walked) / piece));
    walked += piece;
  }
  const int n = int(even.size()), reach = int(std::ceil(3 * sigma / step));
  std::vector<Vec3> smooth(even.size());
  for (int i = 0; i < n; ++i) {
    const int r = std::min({reach, i, n - 1 - i});
    Vec3 sum;
    double weights = 0;
    for (int k = -r; k <= r; ++k) {
      const double w = std::exp(-0.5 * (k * step / sigma) * (k * step / sigma));
      sum += even[i + k] * w;
      weights += w;
    }
    smooth[i] = sum / weights;
  }
  return smooth;
}

}  // namespace trephine::craniometry
