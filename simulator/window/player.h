// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <chrono>
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fluoro/fluoro_thread.h"
#include "render/stage.h"
#include "session/session.h"
#include "window/lesson_desk.h"
#include "window/notes.h"
#include "window/screen_hand.h"

namespace trephine {

struct PlayOptions {
  SessionOptions session;  ///< case, device (empty name: mouse and keyboard), tool, ...
  ScreenHandParams hand;
  ViewParams view;
  std::filesystem::path playback;             ///< a recording to be shown, in place of a session
  std::filesystem::path ghost;                ///< a recording whose way is shown; may be empty
  std::vector<std::filesystem::path> before;  ///< the recordings that it follows, in their order
  std::optional<LessonPlay> lesson;   ///< done in this session; what tools and recording `session` has is ignored
  int head_port = -1;                 ///< of the loopback interface, for the user's head; below 0: none
  std::filesystem::path shots = ".";  ///< folder of pictures that the user takes
};

/// A case that somebody works on, or a recording that is shown: all that the window's keys, its panels and the remote
/// may ask for, without any of them. Calls come from the thread of the OpenGL context.
class Player {
 public:
  /// Loads the case; no context is needed yet. Throws as Patient and Playback do.
  Player(const PlayOptions& options, const std::atomic<bool>& stop);
  ~Player();
  /// Makes the scene in the current context and begins the session; a device that has to be waited for is waited for
  /// in another thread. Throws as Stage and Session do.
  void set_stage();
  void set_stereo(ViewParams::Stereo stereo) { options_.view.stereo = stereo; }  ///< before set_stage()

  /// Takes what the servo did since the last call (or shows the recording's next moment), and makes the scene follow.
  /// `wall_s`: time since the last call. Throws what a session that could not begin throws, and judging a lesson.
  void step(double wall_s);
  /// Ends the session: its recording is complete then. What was said by sessions is in notes(). A lesson that nobody
  /// finished is judged as it is, unless the user cancelled.
  void finish();

  // What a user does. Each returns an empty text, or what is wrong with it.
  std::string take_tool(const std::string& name);  ///< puts the other away; the recording goes on in a further file
  std::string lesson_command(const std::string& name);  ///< of belt_command, or next or back
  std::string move_arm(const std::string& how);         ///< ap, lateral, oblique, orbit_more, ... of a C-arm
  std::string set_view(const std::string& preset);
  std::string set_opacity(const std::string& anatomy, double opacity);
  std::string cut(const std::string& how);  ///< none, tool, axial, coronal, sagittal
  void move_cut(double mm);
  void set_pedal(bool down);
  std::string incise();
  /// A marker with its pedal down goes to the surface under the cursor, and on with it.
  void draw_at(double x, double y, int width, int height);
  bool draws() const;  ///< such a marker is in hand
  void move_tool(Vec3 by_mm);
  void advance_tool(double mm);  ///< along its axis; not where the hand is held back far behind
  void place_tool(Vec3 tip_mm, const std::optional<Vec3>& axis);  ///< takes it away and to that place
  void turn_tool(double right_rad, double up_rad);
  void aim_at_viewer();
  std::string aim_at_target();
  std::string to_surface(double x, double y, int width, int height);
  void pause(bool on);
  void go_to(double time_s);
  std::string set_places(bool shown);
  std::string set_ct_slices(bool shown);
  std::string set_insets(bool shown);
  void set_trace(bool on);
  /// "skull, 12.3, ...", or an empty text.
  std::string under(double x, double y, int width, int height) const;
  /// One line of the remote's protocol; returns the answer, "ok" or "error: ..." or what was asked for. `quit` and
  /// `shot` are for the caller: they set what quits() and takes_shot() return.
  std::string command(const std::string& line);

  OrbitCamera camera;
  Vec3 head_mm;  ///< of the user beside the middle of the window: right, up, towards the user
  Stage& stage() { return *stage_; }
  int stages() const { return stages_; }  ///< how many there were: the review of a lesson has one of its own
  const Patient& patient() const { return *patient_; }
  bool live() const { return !playback_; }
  const Playback* playback() const { return playback_.get(); }
  const ServoFrame& frame() const { return frame_; }
  const LessonDesk* desk() const { return desk_.get(); }            ///< null without a lesson
  bool has_xray() const { return fluoro_ != nullptr && live(); }    ///< a lesson with a C-arm goes on
  bool commanding() const { return desk_ && desk_->commanding(); }  ///< a lesson's command waits for the servo
  /// The X-rays that a review shows, and which of them at its moment: the last one that had begun; -1 before the first.
  const std::vector<LessonShot>& shots_taken() const { return shots_taken_; }
  int shot_shown() const;
  const MadeFluoro* xray() const { return seen_ ? &*seen_ : nullptr; }  ///< the last picture; null before the first
  std::uint64_t xrays_made() const { return xrays_made_; }
  std::vector<std::string> tools() const;
  const std::string& tool() const { return tool_name_; }
  bool pedal() const { return pedal_; }
  bool by_screen() const { return screen_hand_ != nullptr; }
  bool paused() const { return paused_; }
  double speed = 1;                                ///< of a recording that is shown
  double depth_mm() const { return depth_mm_; }    ///< of the tip behind the first surface along the tool; 0 in air
  double target_mm() const { return target_mm_; }  ///< to the nearest target; negative where there is none
  double trace_mm() const { return trace_mm_; }
  bool trace_on() const { return tracing_; }
  double ink_mm() const { return ink_mm_; }  ///< length of the marker's last trace, without a lesson
  const std::string& shape_name(int number) const;
  const std::deque<float>& forces() const { return forces_; }  ///< N, one a picture
  double servo_hz() const { return servo_hz_; }
  double late_us() const { return late_us_; }            ///< the worst since the last picture
  std::uint32_t faults() const { return told_faults_; }  ///< of any session so far
  const Notes& notes() const { return notes_; }
  void note(const std::string& text) { notes_.add(now_s(), text); }
  double now_s() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count(); }
  bool quits() const { return quit_; }
  bool takes_shot() { return std::exchange(shot_, false); }
  void ask_shot() { shot_ = true; }
  void quit() { quit_ = true; }
  std::filesystem::path next_shot();

 private:
  void make_stage();
  void begin_session();
  void meet_session();
  void end_session();
  void follow_session();
  void follow_lesson(const std::vector<ServoFrame>& frames);
  void follow_xray();
  void follow_review_xray();
  std::string xray_state() const;
  void begin_review();
  void ink(const ServoFrame& frame);
  void show_lesson_tool();
  void press_as_needed();
  std::string barred() const;
  std::string lesson_state() const;
  void look_at(const ServoFrame& frame);
  void measure();
  void aim();
  double start_depth_mm() const;
  TouchableFaces visible_faces() const;
  Contact seen(double x, double y, int width, int height) const;

  PlayOptions options_;
  const std::atomic<bool>& stop_;
  std::atomic<bool> end_{false};
  std::shared_ptr<Patient> patient_;
  std::unique_ptr<Playback> playback_;
  std::unique_ptr<Stage> stage_;
  std::shared_ptr<Patient> worked_on_;  // while patient_ is that of a lesson's review
  std::unique_ptr<LessonDesk> desk_;
  std::unique_ptr<FluoroThread> fluoro_;  // reads patient_, or worked_on_
  std::optional<MadeFluoro> seen_;
  std::uint64_t xrays_made_ = 0;
  std::vector<LessonShot> shots_taken_;  // of a review
  int shot_asked_ = -1;
  std::size_t shots_shown_ = 0;
  double exposure_shown_s_ = 0;
  std::unique_ptr<Session> session_;
  std::future<std::unique_ptr<Session>> coming_;  // waits for its device
  std::mutex said_mutex_;
  std::vector<std::string> said_;      // by sessions that are coming
  ScreenHand* screen_hand_ = nullptr;  // the session's
  std::unique_ptr<IncisionWatch> watch_;
  std::vector<IncisionMark> incisions_;
  HandGoal goal_;
  std::shared_ptr<Mailbox<ViewAxes>> view_ = std::make_shared<Mailbox<ViewAxes>>();
  ServoFrame frame_{};
  std::string tool_name_, no_name_, begins_sha256_;
  Vec3 last_trace_mm_;
  std::map<int, std::string> shapes_;
  std::vector<Vec3> ghost_mm_;
  Vec3 last_ink_mm_;
  double ink_mm_ = 0;
  std::uint32_t seen_buttons_ = 0, told_faults_ = 0, session_faults_ = 0;
  int verdict_ = 0;
  std::deque<float> forces_;
  double depth_mm_ = 0, target_mm_ = -1, trace_mm_ = 0, trace_apart_mm_ = 1, servo_hz_ = 0, late_us_ = 0,
         rate_wall_s_ = 0;
  double wall_s_ = 0;
  std::uint64_t rate_ticks_ = 0;
  int sessions_ = 0, shots_ = 0, stages_ = 0;
  bool pedal_ = false, judged_ = false, recorded_ = false;
  bool paused_ = false, tracing_ = false, quit_ = false, shot_ = false, many_incisions_ = false;
  std::size_t told_notes_ = 0;  // of the stage
  const std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  Notes notes_;
};

}  // namespace trephine
