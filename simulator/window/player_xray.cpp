// SPDX-License-Identifier: GPL-3.0-or-later
// The C-arm of a lesson in the window.
#include <fmt/format.h>

#include "window/player.h"

namespace trephine {

std::string Player::move_arm(const std::string& how) {
  if (!desk_) return "this is no lesson";
  if (!desk_->has_arm()) return "this lesson has no C-arm";
  if (!fluoro_) return "the case holds no CT, so there are no X-rays";
  const bool preset = how == "ap" || how == "lateral" || how == "oblique";
  const bool turn = how == "orbit_more" || how == "orbit_less" || how == "tilt_more" || how == "tilt_less";
  if (!preset && !turn)
    return how + ": the arm goes to ap, lateral, oblique, or by orbit_more, orbit_less, tilt_more, tilt_less";
  return lesson_command(preset ? "view_" + how : how);
}

// Asks for the next fluoroscopic picture, and takes the one that is ready. The last one stays when X-rays are off.
void Player::follow_xray() {
  if (!fluoro_ || !live()) return;
  const LessonXray x = desk_->xray();
  fluoro_->move(x.now.arm);
  if (x.shots_count != shots_shown_ || x.exposure_s != exposure_shown_s_) {
    shots_shown_ = x.shots_count;
    exposure_shown_s_ = x.exposure_s;
    fluoro_->show(x.seen.arm, x.metal);
  }
  if (std::optional<MadeFluoro> made = fluoro_->take()) {
    seen_ = std::move(made);
    ++xrays_made_;
  }
}

std::string Player::xray_state() const {
  if (!desk_ || !fluoro_) return "error: there is no C-arm";
  const LessonXray x = desk_->xray();
  std::string text = fmt::format("{} view {} orbit_deg {:g} tilt_deg {:g} exposure_s {:.3f} shots_count {} pictures {}",
                                 x.on ? "on" : "off", x.now.view, x.now.orbit_deg, x.now.tilt_deg, x.exposure_s,
                                 x.shots_count, xrays_made_);
  if (!seen_) return text;
  text += fmt::format(" size_px {} waited_s {:.3f}", seen_->picture.size, seen_->waited_s);
  if (!seen_->metal.empty()) {
    const auto tip = CArm(seen_->arm, seen_->picture.size).project(seen_->metal[0].tip_mm);
    text += fmt::format(" tip_px {:.2f} {:.2f}", tip[0], tip[1]);
  }
  return text;
}

}  // namespace trephine
