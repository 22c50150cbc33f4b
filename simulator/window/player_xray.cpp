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

int Player::shot_shown() const {
  int shown = -1;
  if (playback_)
    for (const LessonShot& s : shots_taken_) shown += s.begin_s <= playback_->time_s();
  return shown;
}

// In a review: what X-rays had shown last by the moment that is looked at.
void Player::follow_review_xray() {
  const int shown = shot_shown();
  if (shown < 0) return;
  if (shown != shot_asked_) {
    shot_asked_ = shown;
    seen_.reset();
    const LessonShot& s = shots_taken_[std::size_t(shown)];
    fluoro_->show(s.seen.arm, s.metal);
  }
  if (std::optional<MadeFluoro> made = fluoro_->take()) {
    const LessonShot& s = shots_taken_[std::size_t(shown)];
    if (made->arm.orbit_deg != s.seen.arm.orbit_deg || made->arm.tilt_deg != s.seen.arm.tilt_deg) return;
    seen_ = std::move(made);
    ++xrays_made_;
  }
}

std::string Player::xray_state() const {
  if (!desk_ || !fluoro_) return "error: there is no C-arm";
  if (playback_) {
    const int n = shot_shown();
    std::string text = fmt::format("review shot {} of {}", n + 1, shots_taken_.size());
    if (n < 0) return text;
    const LessonShot& s = shots_taken_[std::size_t(n)];
    text += fmt::format(" begin_s {:.3f} end_s {:.3f} view {} orbit_deg {:g} tilt_deg {:g} pictures {}", s.begin_s,
                        s.end_s, s.seen.view, s.seen.orbit_deg, s.seen.tilt_deg, xrays_made_);
    if (!seen_) return text;
    const auto tip = CArm(seen_->arm, seen_->picture.size).project(seen_->metal[0].tip_mm);
    return text + fmt::format(" size_px {} tip_px {:.2f} {:.2f}", seen_->picture.size, tip[0], tip[1]);
  }
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
