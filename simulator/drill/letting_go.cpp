// SPDX-License-Identifier: GPL-3.0-or-later
#include "drill/letting_go.h"

#include <algorithm>
#include <cmath>

#include "base/pi.h"

namespace trephine::drill {
namespace {

constexpr int places = 96;
constexpr double before_voxels = 0.75;  // where a cutter that cuts a little wider than its tool still finds its wall
constexpr double weak_share = 1.0 / 7, free_share = 1.5 / places;
constexpr double least_n = 0.3, least_ratio = 0.01;
constexpr double fresh_share = 0.15, longest_loose_s = 0.05;
constexpr double slower = 0.6;  // for what a cutter takes beyond its own surface

}  // namespace

void LettingGo::add(const Cutter& c) {
  Front f;
  const bool ball = c.kind == Cutter::Kind::ball;
  f.round = ball || c.round_end;
  const double a = ball ? c.radius_mm : c.semi_a_mm, b = ball ? c.radius_mm : c.semi_b_mm;
  const double before_mm = before_voxels * contact_.smallest_side_mm();
  f.radius_mm = a;
  f.area_mm2 = pi * a * b;
  for (int n = 0; n < places; ++n) {  // evenly over the disc, along a spiral
    const double r = std::sqrt((n + 0.5) / places), turn = pi * (3 - std::sqrt(5.0)) * n;
    const Vec3 disc{r * std::cos(turn), r * std::sin(turn), f.round ? -std::sqrt(1 - r * r) : 0.0};
    f.at_mm.push_back(f.round ? disc * (a + before_mm) + Vec3{0, 0, a} : Vec3{a * disc.x, b * disc.y, -before_mm});
  }
  fronts_.push_back(std::move(f));
}

bool LettingGo::is_loose() const { return ratio_ <= least_ratio; }

double LettingGo::share_left(const ToolPose& tool) const {
  int held = 0;
  for (const Vec3& p : fronts_[std::size_t(held_)].at_mm) {
    const int shape = contact_.shape_at(tool.tip_mm + tool.frame * p);
    held += shape > 0 && (bone_ >> shape & 1);
  }
  return double(held) / places;
}

bool LettingGo::look(const ToolPose& tool, double pressure_n, double dt_s) {
  if (!through_) return false;
  const Front& front = fronts_[std::size_t(held_)];
  const double share = share_left(tool);
  // Where something else holds the cutter, what is left of the bone beside it holds nothing either.
  if (is_loose()) loose_s_ += dt_s;
  if (share < free_share || loose_s_ > longest_loose_s) {
    rest();
    return true;
  }
  if (breaks_ && share > from_ + fresh_share) hold_again();  // the cutter has gone on into other bone
  if (!breaks_ && (share < weak_share || pressure_n > share * front.area_mm2 * strength_n_per_mm2_)) {
    breaks_ = true;
    from_ = share;
    // A little slower than it may.
    fall_per_s_ = 900 * max_n_per_ms_ / std::max(pressure_n, least_n);
  }
  if (!breaks_) return false;
  ratio_ = std::max(least_ratio, ratio_ - fall_per_s_ * dt_s);
  // Of a ball that share is left at (1 - x / r)^2: what is left of its way takes as long as the force takes.
  const double left_mm = front.radius_mm * (std::sqrt(share) - std::sqrt(free_share)),
               ticks = (ratio_ - least_ratio) / (fall_per_s_ * dt_s);
  most_mm_ = is_loose() ? HUGE_VAL : slower * left_mm / std::max(ticks, 1.0);
  return false;
}

}  // namespace trephine::drill
