// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/screen_hand.h"

#include "haptics/proxy.h"

namespace trephine::window {

ScreenHand::ScreenHand(const ScreenHandParams& p, const HandGoal& begin)
    : goal_(begin),
      hand_({p.hand_mass_kg, p.hand_stiffness_n_per_mm, p.hand_damping_n_s_per_mm + own_damping, p.hand_most_n},
            begin.tip_mm),
      axis_(normalized(begin.axis)) {}

bool ScreenHand::read(double dt_s, device::DeviceReading& out) {
  const std::uint32_t lifts = goal_.lifts;
  goals_.read(goal_);
  const bool lifted = goal_.lifts != lifts;
  if (lifted) {
    hand_.put(goal_.tip_mm);
    axis_ = normalized(goal_.axis);
  }
  hand_.follow(goal_.tip_mm, dt_s, goal_.min_most_n);
  axis_ = device::turned_towards(axis_, normalized(goal_.axis), dt_s);
  out = {};
  out.tip_mm = hand_.position_mm();
  out.axis = axis_;
  out.buttons = lifted ? haptics::haptic_button::lifted : goal_.buttons;
  return is_finite(out.tip_mm);
}

void ScreenHand::send(Vec3 force_n) { hand_.feel(force_n); }

}  // namespace trephine::window
