// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/review.h"

namespace trephine::window {
namespace {

constexpr int xray_px = 512;

}  // namespace

void ShownRecording::step(double wall_s, CaseView& view) {
  if (!paused) playback_->go_to(playback_->time_s() + wall_s * speed);
  std::size_t count = 0;
  for (const session::IncisionMark& m : playback_->incisions()) count += m.time_s <= playback_->time_s();
  view.stage().show_incisions(playback_->incisions(), count);
  if (view.stage().view().dust)
    dust_.go_to(playback_->frames(), playback_->frame_number() + 1, playback_->recording().second);
  view.stage().show_dust(dust_.dust());
  if (playback_->tool_name() != tool_name_) show_tool(view);
  view.look_at(playback_->frame(), playback_->held_second(), playback_->second_frame());
}

void ShownRecording::show_tool(CaseView& view) {
  tool_name_ = playback_->tool_name();
  view.stage().set_tool(playback_->tool());
}

XrayPictures::XrayPictures(std::shared_ptr<const session::Patient> patient)
    : patient_(std::move(patient)), thread_(patient_->felt.loaded.ct, xray_px) {}

void XrayPictures::follow(const lessons::LessonXray& x) {
  thread_.move(x.now.arm);
  if (x.shots_count != shots_ || x.exposure_s != exposure_s_) {
    shots_ = x.shots_count;
    exposure_s_ = x.exposure_s;
    thread_.show(x.seen.arm, x.metal);
  }
  take(thread_.take());
}

void XrayPictures::ask(const lessons::LessonShot& shot) {
  last_.reset();
  thread_.show(shot.seen.arm, shot.metal);
}

void XrayPictures::take(const lessons::LessonShot& shot) {
  std::optional<fluoro::MadeFluoro> made = thread_.take();
  if (made && made->arm.orbit_deg == shot.seen.arm.orbit_deg && made->arm.tilt_deg == shot.seen.arm.tilt_deg)
    take(std::move(made));
}

void XrayPictures::take(std::optional<fluoro::MadeFluoro> made) {
  if (!made) return;
  last_ = std::move(made);
  ++made_;
}

void ShotReview::show(double time_s, XrayPictures& pictures) {
  shown_ = -1;
  for (const lessons::LessonShot& s : shots_) shown_ += s.begin_s <= time_s;
  if (shown_ < 0) return;
  const lessons::LessonShot& shot = shots_[std::size_t(shown_)];
  if (shown_ != asked_) {
    asked_ = shown_;
    pictures.ask(shot);
  }
  pictures.take(shot);
}

}  // namespace trephine::window
