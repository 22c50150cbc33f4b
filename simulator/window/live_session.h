// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "scene/bone_dust.h"
#include "session/moving_target.h"
#include "session/playback.h"
#include "window/hand.h"
#include "window/lesson_controller.h"
#include "window/notes.h"
#include "window/theatre.h"

namespace trephine::window {

/// With what force a hand of mouse and keyboard may pull a tool, so that it goes through bone while tissue holds its
/// tip and its whole shaft; no more than a device of `max_force_n` can hold. 0: the tool pierces nothing.
double piercing_n(const haptics::BeltToolParams& tool, const cases::CaseHaptic& haptic, double max_force_n);

/// Somebody at work on the patient of a view: the servo's session, one after the other where tools are changed, what
/// they cut and drew, and the lesson that is done in it, if it is one. In the thread of the OpenGL context.
class LiveSession {
 public:
  /// `lesson` may be null. What is given must outlive it. begin() comes next.
  LiveSession(const session::SessionOptions& options, const ScreenHandParams& hand, const std::string& site,
              std::shared_ptr<session::Patient> patient, CaseView& view, LessonController* lesson, Notes& notes);
  ~LiveSession();
  /// A device that has to be waited for is waited for in another thread. Throws as Session does.
  void begin();
  /// Takes what the servo did since the last call, and shows it. `wall_s`: time since then. Throws what a session that
  /// could not begin throws; then failed() says so.
  void step(double wall_s);
  void end();  ///< the recording is complete then

  texts::Answer take_tool(const std::string& name);  ///< puts the other away; the recording goes on in a further file
  /// Takes another burr than the one in hand (other_burr); in a lesson of those that it offers.
  texts::Answer change_burr(const std::string& asked);
  bool holds_burr() const;
  double burr_mm() const;  ///< the width of the burr in hand
  void set_pedal(bool down);
  texts::Answer incise();
  texts::Answer command(const std::string& name);  ///< a name of belt_command, for the lesson or the drill
  bool cuts() const { return session_ && session_->drilling(); }
  bool draws() const;  ///< a marker is in hand, which the cursor leads
  Hand hand;
  device::WindowPlace window_place;  ///< for a device that is registered to the screen

  bool begun() const { return session_ != nullptr; }
  bool failed() const { return failed_; }
  bool stopped() const { return session_ && !session_->running(); }  ///< by itself
  bool recorded() const { return recorded_; }                        ///< one ended, so there is a recording of it
  const std::string& tool() const { return tool_name_; }
  const std::vector<session::IncisionMark>& incisions() const { return incisions_; }
  double ink_mm() const { return ink_mm_; }  ///< length of the marker's last trace, without a lesson
  double servo_hz() const { return servo_hz_; }
  double late_us() const { return late_us_; }       ///< the worst since the last picture
  std::uint32_t faults() const { return faults_; }  ///< of any session so far

 private:
  texts::Answer take(const haptics::ToolParams& next);
  haptics::ToolParams held() const;
  void meet();
  void tell_screen();
  void follow();
  void follow_second(std::uint32_t faults);
  void follow_lesson(const std::vector<haptics::ServoFrame>& frames);
  void press_as_needed();
  void ink(const haptics::ServoFrame& frame);

  session::SessionOptions options_;
  const ScreenHandParams hand_params_;
  std::shared_ptr<session::Patient> patient_;
  CaseView& view_;
  LessonController* lesson_;
  std::unique_ptr<Theatre> theatre_;  // of the lesson
  Notes& notes_;
  std::atomic<bool> end_{false};
  std::unique_ptr<session::Session> session_;
  std::future<std::unique_ptr<session::Session>> coming_;  // waits for its device
  std::shared_ptr<ScreenHand*> screen_hand_;               // of the session that comes, once it is there
  std::mutex heard_mutex_;
  std::vector<texts::Note> heard_;  // of sessions that are coming
  std::unique_ptr<session::IncisionWatch> watch_;
  std::unique_ptr<session::TargetWatch> target_watch_;  // null: no target is followed
  std::vector<session::IncisionMark> incisions_;
  std::shared_ptr<scene::BoneDust> dust_ = std::make_shared<scene::BoneDust>();  // of all sessions
  std::unique_ptr<scene::DustWatch> dust_watch_;
  std::shared_ptr<device::Mailbox<device::ScreenView>> screen_ =
      std::make_shared<device::Mailbox<device::ScreenView>>();
  std::shared_ptr<device::Mailbox<device::ViewAxes>> axes_ = std::make_shared<device::Mailbox<device::ViewAxes>>();
  std::shared_ptr<session::ButtonBoard> board_ = std::make_shared<session::ButtonBoard>();  // without a lesson
  std::string tool_name_, begins_sha256_;
  Vec3 last_ink_mm_;
  double ink_mm_ = 0, servo_hz_ = 0, late_us_ = 0, wall_s_ = 0, rate_wall_s_ = 0;
  std::uint64_t rate_ticks_ = 0;
  std::uint32_t seen_buttons_ = 0, faults_ = 0, session_faults_ = 0, second_faults_ = 0;
  int sessions_ = 0;
  bool recorded_ = false, failed_ = false, many_incisions_ = false;
};

}  // namespace trephine::window
