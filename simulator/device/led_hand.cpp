// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/led_hand.h"

#include <algorithm>
#include <cmath>

namespace trephine::device {
namespace {

constexpr double turning_s = 0.05;

double within(double span_s) { return std::clamp(span_s, 0.0, 0.1); }

}  // namespace

void LedHand::follow(Vec3 goal_mm, double span_s, double min_most_n) {
  // An explicit step must be fine beside what mass, spring and damper do.
  const double max_n = std::max(spring_.max_n, min_most_n);
  const double damping = spring_.damping_n_s_per_mm;
  const double max_step_s = std::min(1e-4, 0.2 * spring_.mass_kg / (1000 * damping));
  const double span = within(span_s);
  const int steps = std::max(1, int(std::ceil(span / max_step_s)));
  const double h = span / steps;
  for (int n = 0; n < steps; ++n) {
    Vec3 pull = (goal_mm - position_mm_) * spring_.stiffness_n_per_mm;
    if (const double size = norm(pull); size > max_n) pull = pull * (max_n / size);
    const Vec3 force = force_n_ + pull - velocity_ * damping;
    velocity_ += force * (1000 * h / spring_.mass_kg);  // N / kg are m / s^2
    position_mm_ += velocity_ * h;
  }
}

void LedHand::put(Vec3 at_mm) {
  position_mm_ = at_mm;
  velocity_ = {};
  force_n_ = {};
}

Vec3 turned_towards(Vec3 axis, Vec3 goal, double span_s) {
  const Vec3 turned = axis + (goal - axis) * std::min(1.0, within(span_s) / turning_s);
  return norm(turned) > 1e-3 ? normalized(turned) : axis;
}

}  // namespace trephine::device
