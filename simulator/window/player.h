// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "window/live_session.h"
#include "window/review.h"

namespace trephine::window {

struct PlayOptions {
  session::SessionOptions session;  ///< case, device (empty name: mouse and keyboard), tool, ...
  ScreenHandParams hand;
  scene::ViewParams view;
  std::filesystem::path playback;             ///< a recording to be shown, in place of a session
  std::filesystem::path ghost;                ///< a recording whose way is shown; may be empty
  std::vector<std::filesystem::path> before;  ///< the recordings that it follows, in their order
  std::optional<LessonPlay> lesson;   ///< done in this session; what tools and recording `session` has is ignored
  int head_port = -1;                 ///< of the loopback interface, for the user's head; below 0: none
  bool remote_tells_all = false;      ///< `state` in a lesson too, what a surgeon would not see
  std::filesystem::path shots = ".";  ///< folder of pictures that the user takes
};

/// What a window shows: a patient, and either somebody at work on it or a recording of that. A lesson is worked on
/// first, and shown at its end. actions.h has what its user does. Calls come from the thread of the OpenGL context.
class Player {
 public:
  /// Loads the case; no context is needed yet. Throws as Patient and Playback do.
  Player(const PlayOptions& options, const std::atomic<bool>& stop);
  void set_stereo(scene::ViewParams::Stereo stereo) { options_.view.stereo = stereo; }  ///< before set_stage()
  /// Makes the scene in the current context and begins the session. Throws as Stage and Session do.
  void set_stage();
  /// `wall_s`: time since the last call. Throws what a session that could not begin throws, and judging a lesson.
  void step(double wall_s);
  /// Ends the session: its recording is complete then. A lesson that nobody finished is judged as it is, unless the
  /// user cancelled.
  void finish();

  CaseView& view() { return *view_; }
  const CaseView& view() const { return *view_; }
  int stages() const { return stages_; }       ///< how many there were: the review of a lesson has one of its own
  LiveSession* live() { return live_.get(); }  ///< null where a recording is shown
  const LiveSession* live() const { return live_.get(); }
  ShownRecording* shown() { return shown_.get(); }  ///< null where somebody is at work
  const ShownRecording* shown() const { return shown_.get(); }
  const LessonController* lesson() const { return lesson_.get(); }  ///< null where there is none
  LessonController* lesson() { return lesson_.get(); }
  bool in_lesson() const { return lesson_ && live_; }  ///< and it goes on
  /// Whether the remote may say where the tip is: outside of a lesson, or where that was asked for.
  bool tells_tip() const { return !in_lesson() || options_.remote_tells_all; }
  const XrayPictures* xrays() const { return xrays_.get(); }  ///< of a lesson with a C-arm; else null
  XrayPictures* xrays() { return xrays_.get(); }
  const ShotReview* shots() const { return shots_.get(); }  ///< of the review of such a lesson; or null
  std::vector<std::string> tools() const;
  const std::string& tool() const { return live_ ? live_->tool() : shown_->tool(); }
  std::uint32_t faults() const { return live_ ? live_->faults() : faults_; }
  Notes notes;
  device::WindowPlace window_place;  ///< of the window, for a device that is registered to the screen
  Vec3 head_mm;                      ///< of the user beside the middle of the window: right, up, towards the user

  void quit() { quits_ = true; }
  bool quits() const { return quits_; }
  void ask_shot() { takes_shot_ = true; }
  bool takes_shot() { return std::exchange(takes_shot_, false); }
  /// In the folder of pictures: STEM-001ENDING, or under the first number that is free.
  std::filesystem::path next_file(const std::string& stem, const std::string& ending) const;

 private:
  void make_view(std::shared_ptr<session::Patient> patient, const scene::ViewParams& params);
  void begin_review();

  PlayOptions options_;
  const std::atomic<bool>& stop_;
  std::shared_ptr<session::Patient> patient_;  // a review has its own
  std::vector<Vec3> ghost_mm_;
  std::unique_ptr<LessonController> lesson_;
  std::unique_ptr<XrayPictures> xrays_;
  std::unique_ptr<ShownRecording> shown_;
  std::unique_ptr<ShotReview> shots_;
  std::unique_ptr<CaseView> view_;
  std::unique_ptr<LiveSession> live_;
  std::size_t told_notes_ = 0;  // of the stage
  std::uint32_t faults_ = 0;    // of the sessions before a review
  int stages_ = 0;
  bool judged_ = false, quits_ = false, takes_shot_ = false;
};

}  // namespace trephine::window
