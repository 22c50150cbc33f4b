// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/screen_hand.h"

#include <algorithm>
#include <cmath>

#include "haptics/proxy.h"

namespace trephine {
namespace {

constexpr double turning_s = 0.05;  // in which most of a turn of the goal is followed

}  // namespace

ScreenHand::ScreenHand(const ScreenHandParams& params, const HandGoal& begin)
    : params_(params), goal_(begin), position_mm_(begin.tip_mm), axis_(normalized(begin.axis)) {}

bool ScreenHand::read(double dt_s, DeviceReading& out) {
  const std::uint32_t lifts = goal_.lifts;
  goals_.read(goal_);
  const bool lifted = goal_.lifts != lifts;
  if (lifted) {
    position_mm_ = goal_.tip_mm;
    axis_ = normalized(goal_.axis);
    velocity_ = {};
    force_n_ = {};
  }
  const double damping = params_.hand_damping_n_s_per_mm + damping_n_s_per_mm();
  // An explicit step must be fine beside what mass, spring and damper do.
  const double most_step_s = std::min(1e-4, 0.2 * params_.hand_mass_kg / (1000 * damping));
  const double span = std::clamp(dt_s, 0.0, 0.1);
  const int steps = std::max(1, int(std::ceil(span / most_step_s)));
  const double h = span / steps;
  for (int n = 0; n < steps; ++n) {
    Vec3 pull = (goal_.tip_mm - position_mm_) * params_.hand_stiffness_n_per_mm;
    if (const double size = norm(pull); size > params_.hand_most_n) pull = pull * (params_.hand_most_n / size);
    const Vec3 force = force_n_ + pull - velocity_ * damping;
    velocity_ += force * (1000 * h / params_.hand_mass_kg);  // N / kg are m / s^2
    position_mm_ += velocity_ * h;
  }
  const Vec3 turned = axis_ + (normalized(goal_.axis) - axis_) * std::min(1.0, span / turning_s);
  if (norm(turned) > 1e-3) axis_ = normalized(turned);
  out = {};
  out.tip_mm = position_mm_;
  out.axis = axis_;
  out.buttons = lifted ? haptic_button::lifted : goal_.buttons;
  return is_finite(position_mm_);
}

void ScreenHand::send(Vec3 force_n) { force_n_ = force_n; }

}  // namespace trephine
