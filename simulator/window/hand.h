// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "window/case_view.h"
#include "window/screen_hand.h"

namespace trephine::window {

/// Where the user wants the tool, and its buttons. They reach the session where mouse and keyboard hold the tool; a
/// device of its own moves by itself.
class Hand {
 public:
  /// Begins before the site, or above the middle; `behind`: behind the patient, pointing forwards.
  Hand(CaseView& view, const std::string& site, bool behind);

  void move(Vec3 by_mm);
  /// To the right and up in the picture; `draws`: along the surface that is seen there.
  void move_in_picture(double right_mm, double up_mm, const Cursor& picture, bool draws);
  void advance(double mm);  ///< along the tool; not where the hand is held back far behind
  void place(Vec3 tip_mm, const std::optional<Vec3>& axis);  ///< takes it away and to that place
  void turn(double right_rad, double up_rad);
  void aim_at_viewer();
  texts::Answer aim_at_target();
  texts::Answer to_surface(const Cursor& cursor);
  /// A marker goes to the surface under the cursor, and on with it.
  void draw_at(const Cursor& cursor);
  void press(std::uint32_t button, bool down);
  bool pressed(std::uint32_t button) const { return goal_.buttons & button; }
  void pull_at_least(double max_n);  ///< HandGoal::min_most_n

  const HandGoal& goal() const { return goal_; }
  bool by_screen() const { return screen_ != nullptr; }
  void hold_by(ScreenHand* screen) { screen_ = screen; }  ///< null: by a device, or by nobody

 private:
  void aim();
  CaseView& view_;
  HandGoal goal_;
  ScreenHand* screen_ = nullptr;  // the session's
};

}  // namespace trephine::window
