// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fluoro/fluoro_thread.h"
#include "lessons/lesson_type.h"
#include "scene/bone_dust.h"
#include "session/playback.h"
#include "window/case_view.h"

namespace trephine::window {

/// A recording that is shown, at any of its times.
class ShownRecording {
 public:
  explicit ShownRecording(std::unique_ptr<session::Playback> playback)
      : playback_(std::move(playback)), dust_(scene::dust_watch_of(*playback_)) {}
  /// Goes on by that time, and shows the moment.
  void step(double wall_s, CaseView& view);
  void show_tool(CaseView& view);
  void go_to(double time_s) { playback_->go_to(time_s); }
  /// What bleeds in it; `down` (unit): where it runs.
  void bleed(std::vector<scene::Bleeding> bleedings, Vec3 down) { dust_.bleed(std::move(bleedings), down); }
  const session::Playback& playback() const { return *playback_; }
  const std::string& tool() const { return tool_name_; }
  bool paused = false;
  double speed = 1;

 private:
  std::unique_ptr<session::Playback> playback_;
  scene::DustWatch dust_;
  std::string tool_name_;
};

/// The pictures of a C-arm, as they are made.
class XrayPictures {
 public:
  explicit XrayPictures(std::shared_ptr<const session::Patient> patient);
  /// Asks for what the lesson shows now, and takes what is ready. The last one stays when X-rays are off.
  void follow(const lessons::LessonXray& xray);
  /// Asks for one of a review; a picture of another one is not shown.
  void ask(const lessons::LessonShot& shot);
  void take(const lessons::LessonShot& shot);
  const fluoro::MadeFluoro* last() const { return last_ ? &*last_ : nullptr; }  ///< null before the first
  std::uint64_t made() const { return made_; }
  /// Whether the monitor exchanges left and right. An arm sees a patient from the front (fluoro::CArmParams).
  bool flipped = false;

 private:
  void take(std::optional<fluoro::MadeFluoro> made);
  std::shared_ptr<const session::Patient> patient_;  // whose CT the thread reads
  fluoro::FluoroThread thread_;
  std::optional<fluoro::MadeFluoro> last_;
  std::uint64_t made_ = 0;
  std::size_t shots_ = 0;
  double exposure_s_ = 0;
};

/// The X-rays of a lesson, in its review: at each of its times the last ones that had begun.
class ShotReview {
 public:
  explicit ShotReview(std::vector<lessons::LessonShot> shots) : shots_(std::move(shots)) {}
  const std::vector<lessons::LessonShot>& shots() const { return shots_; }
  int shown() const { return shown_; }  ///< -1 before the first
  void show(double time_s, XrayPictures& pictures);

 private:
  std::vector<lessons::LessonShot> shots_;
  int shown_ = -1, asked_ = -1;
};

}  // namespace trephine::window
