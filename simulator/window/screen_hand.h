// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "device/device.h"
#include "device/led_hand.h"
#include "device/mailbox.h"

namespace trephine::window {

/// How mouse and keyboard hold the tool.
struct ScreenHandParams {
  double hand_mass_kg = 0.2, hand_stiffness_n_per_mm = 0.4, hand_damping_n_s_per_mm = 0.006;
  double hand_most_n = 2.2;
  double wheel_mm = 0.5, advance_mm_per_s = 4, move_mm_per_s = 12, turn_deg_per_s = 45;
  template <class V>
  static void describe(V& v) {
    using P = ScreenHandParams;
    v.number(&P::hand_mass_kg, "hand_mass_kg", Range{0.02, 5}, "Mass of the hand that follows the mouse.");
    v.number(&P::hand_stiffness_n_per_mm, "hand_stiffness_n_per_mm", Range{0.01, 5},
             "How firmly that hand follows: surfaces and bone hold it back by this force for each mm.");
    v.number(&P::hand_damping_n_s_per_mm, "hand_damping_n_s_per_mm", Range{0.0005, 0.1}, "Its damping.");
    v.number(&P::hand_most_n, "hand_most_n", Range{0.1, 50},
             "It never pulls harder, so that a burr is not pressed until it stalls; with a needle for bone, as hard as "
             "that needs.");
    v.number(&P::wheel_mm, "wheel_mm", Range{0.01, 20}, "Way along the tool for a step of the wheel.");
    v.number(&P::advance_mm_per_s, "advance_mm_per_s", Range{0.01, 100},
             "Speed along the tool while W (forwards) or S (back) is down.");
    v.number(&P::move_mm_per_s, "move_mm_per_s", Range{0.01, 200},
             "Speed in the picture's plane while Shift and an arrow key are down.");
    v.number(&P::turn_deg_per_s, "turn_deg_per_s", Range{1, 360},
             "Speed of turning while an arrow key is down: the tool, or with Ctrl the view.");
  }
};

/// Where the window wants the hand.
struct HandGoal {
  Vec3 tip_mm, axis{0, 0, 1};
  std::uint32_t buttons = 0;
  std::uint32_t lifts = 0;  ///< a new number: the hand takes the tool away, and is at the goal at once
  double min_most_n = 0;    ///< it may pull as hard as that, whatever hand_most_n says: what the tool needs to pierce
};

/// A hand that is led (device/led_hand.h) to a goal of another thread.
class ScreenHand : public device::Device {
 public:
  ScreenHand(const ScreenHandParams& params, const HandGoal& begin);
  void aim(const HandGoal& goal) { goals_.write(goal); }
  double damping_n_s_per_mm() const override { return own_damping; }
  bool read(double dt_s, device::DeviceReading& out) override;
  void send(Vec3 force_n) override;

 private:
  static constexpr double own_damping = 0.002;
  device::Mailbox<HandGoal> goals_;
  HandGoal goal_;
  device::LedHand hand_;
  Vec3 axis_;
};

}  // namespace trephine::window
