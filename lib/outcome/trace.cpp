// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/trace.h"

#include <algorithm>
#include <cmath>

#include "base/pi.h"
#include "mask/filters.h"
#include "outcome/bone_points.h"

namespace trephine::outcome {
namespace {

constexpr double step_mm = 0.5, grid_mm = 0.4;
constexpr double gone_ratio = 0.3;  ///< of what is dense across it: less is its end
constexpr double air_about_hu = -300;
constexpr double bridge_aside_mm = 0.1;         ///< for each step of a bridge
constexpr std::size_t beyond_bridge_steps = 6;  ///< fewer beyond it are something else
constexpr double cap_mm = 0.3;  ///< by which a rounded end of 2.5 mm is farther out than a flat one of its volume

}  // namespace

Section section_of(const ScanView& scan, Vec3 at, const Frame& f, const TraceParams& is) {
  Section s;
  std::vector<float> ring;
  for (int n = 0; n < 24; ++n) {
    const double turn = 2 * pi * n / 24, r = n % 2 ? is.ring_from_mm : is.ring_to_mm;
    const Vec3 p = at + f.a * (r * std::cos(turn)) + f.b * (r * std::sin(turn));
    const double v = scan(p);
    if (v <= ScanView::beyond_hu / 2) return s.beyond = true, s;
    const bool other = is.is_other && is.is_other(p);
    s.obscured = s.obscured || other || v < air_about_hu;
    if (!other) ring.push_back(float(v));
  }
  const double median = double(mask::median(ring, 0));
  const double least = is.in_air && median < air_about_hu ? -1000 : -20;
  const double around = std::clamp(median, least, is.most_around_hu);  // not of air or bone beside it
  s.around_hu = around;
  const int n = int(is.disc_mm / grid_mm);
  double weight = 0;
  Vec3 sum;
  std::vector<std::pair<Vec3, double>> all;
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j) {
      const Vec3 off = f.a * (i * grid_mm) + f.b * (j * grid_mm);
      if (norm(off) > is.disc_mm) continue;
      const double v = scan(at + off);
      if (v <= ScanView::beyond_hu / 2) return s.beyond = true, s;
      if (is.is_other && is.is_other(at + off)) {
        s.obscured = true;
        continue;
      }
      const double above = std::max(0.0, v - around);
      s.peak = std::max(s.peak, above);
      s.sum += (v > around - 60 ? v - around : 0) * grid_mm * grid_mm;
      all.emplace_back(off, above);
    }
  for (const auto& [off, above] : all) {
    const double w = above > 0.2 * s.peak ? above : 0;
    weight += w;
    sum += off * w;
  }
  s.middle_mm = weight > 0 ? at + sum * (1 / weight) : at;
  return s;
}

double median_sum(const std::vector<Step>& steps, std::size_t most) {
  std::vector<float> sums;
  for (std::size_t n = steps.size() - std::min(most, steps.size()); n < steps.size(); ++n)
    sums.push_back(float(steps[n].section.sum));
  return double(mask::median(sums, 0));
}

std::vector<Step> followed(const ScanView& scan, Vec3 from, Vec3 way, double reference, const TraceParams& is) {
  std::vector<Step> steps;
  Vec3 at = from, u = normalized(way);
  int missed = 0;
  std::size_t bridged = 0;  ///< steps before the last bridge
  for (int n = 0; n < 400; ++n) {
    const Section s = section_of(scan, at, Frame(u), is);
    const Vec3 moved = s.middle_mm - at;
    const Vec3 off = moved - u * dot(moved, u);
    if (s.beyond || s.sum < gone_ratio * reference || s.sum > is.thick_ratio * reference ||
        norm(off) > is.most_aside_mm + missed * bridge_aside_mm) {
      if (s.beyond || !s.obscured || ++missed > is.bridged_steps) break;
      if (missed == 1 && steps.size() >= bridged + beyond_bridge_steps) bridged = steps.size();
      at += u * step_mm;
      continue;
    }
    missed = 0;
    at += off * 0.7;
    steps.push_back({at, s});
    const std::size_t back = std::size_t(is.turn_steps);
    if (steps.size() > back) u = normalized(u * 0.6 + normalized(at - steps[steps.size() - back - 1].at_mm) * 0.4);
    at += u * step_mm;
  }
  if (bridged > 0 && steps.size() < bridged + beyond_bridge_steps) steps.resize(bridged);
  return steps;
}

Vec3 tip_of(const ScanView& scan, const std::vector<Step>& towards_tip, const TraceParams& is) {
  std::vector<Vec3> last;
  const std::size_t n = towards_tip.size(), skip = std::min<std::size_t>(4, n / 4),
                    take = std::min<std::size_t>(std::size_t(is.tip_steps), n - skip);
  for (std::size_t k = n - skip - take; k < n - skip; ++k) last.push_back(towards_tip[k].at_mm);
  const Line line = line_through(last);
  const Frame frame(line.way);
  const Vec3 begin = line.at_mm + line.way * dot(last.back() - line.at_mm, line.way);
  std::vector<float> sums;
  for (double s = std::max(-8.0, -step_mm * is.tip_steps); s <= -2; s += 0.5)
    sums.push_back(float(section_of(scan, begin + line.way * s, frame, is).sum));
  const double half = 0.5 * double(mask::median(sums, 0));
  double before = section_of(scan, begin - line.way * 2, frame, is).sum;
  for (double s = -1.8; s < 8; s += 0.2) {
    const double now = section_of(scan, begin + line.way * s, frame, is).sum;
    if (now < half) {
      const double at = s - 0.2 * (now == before ? 0 : (half - now) / (before - now));
      return begin + line.way * (at + cap_mm);
    }
    before = now;
  }
  return towards_tip.back().at_mm;
}

double width_mm(const Section& s) { return std::sqrt(std::max(0.0, s.sum / s.peak / 1.133)); }

}  // namespace trephine::outcome
