// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "device/device_type.h"
#include "device/screen_registration.h"
#include "device/workspace.h"
#include "haptics/recording.h"
#include "haptics/servo.h"
#include "session/button_board.h"
#include "session/felt_case.h"
#include "session/second_hand.h"
#include "sound/live_sound.h"

namespace trephine::session {

/// What is felt, and stays where one tool is put away and another taken.
struct Patient {
  FeltCase felt;
  contact::ContactVolume contact;
  drill::DirtyBricks marks;  ///< of what was cut, for who shows it
  /// The voxels as the case has them, where earlier recordings had cut some (patient_again); else null.
  std::shared_ptr<const grid::Grid<std::int16_t>> uncut;
  Patient(FeltCase case_, const contact::ContactParams& params)
      : felt(std::move(case_)), contact(felt.loaded.haptic, params), marks(felt.loaded.haptic.voxels) {}
  Patient(const std::filesystem::path& folder, const std::string& shape, const contact::ContactParams& params,
          cases::LoadParts parts = {})
      : Patient(FeltCase(folder, shape, parts), params) {}
};
/// Asks the patient's volume, as it is at that time, for the shape at a place; 0 for none. It keeps the patient.
std::function<int(Vec3)> shape_at_of(std::shared_ptr<const Patient> patient);

/// The options of a session.
struct SessionOptions {
  std::filesystem::path case_folder;
  std::string shape;  ///< the only shape that is felt; empty: all of the case
  device::DeviceChoice device;
  /// Makes the device instead, where it is given: a window is its own.
  std::function<std::unique_ptr<device::Device>(const device::DeviceScene&)> own_device;
  std::shared_ptr<device::Mailbox<device::ViewAxes>> view;  ///< of a window, for a device that is pushed; may be null
  std::optional<device::HandBegin> begin;                   ///< where a hand that is led begins, in the case
  std::string begins_sha256;  ///< of the voxels of the patient that is given, where it was cut before; else empty
  bool watched = false;       ///< take_frames() gives every frame, also without a recording
  bool stepped = false;       ///< the caller makes each tick by step(), and never calls start()
  device::WorkspaceParams workspace;
  /// Of a mirror workbench: the device is brought before the screen, and moves as the view that `screen_view` tells.
  std::optional<device::ScreenRegistration> screen;
  std::shared_ptr<device::Mailbox<device::ScreenView>> screen_view;  ///< read by the servo thread alone
  std::optional<SecondOptions> second;                               ///< the other hand; none: there is one
  double seconds = 10;
  haptics::ServoParams servo;
  contact::ContactParams contact;
  haptics::ForceParams force;
  haptics::PortParams port;
  haptics::FreeParams free;
  haptics::ToolParams tool;
  haptics::DrillingParams drilling;
  drill::DrillParams law;
  haptics::ShaftParams shaft;
  haptics::TargetParams target;
  sound::LiveSoundParams sound;  ///< without a clock nothing is heard
  /// Of a lesson: the hand holds one of them at a time (haptics/tool_belt.h), and `tool` is ignored. What drills does
  /// so where the case can be drilled. Empty: `tool` alone.
  std::vector<haptics::BeltToolParams> tools;
  std::string lesson, participant, task;  ///< the module, an anonymous token, and what is asked for; for the header
  std::string rubric_sha256;              ///< also for the header, as what follows
  std::vector<haptics::AskedQuestion> asked;
  int record_server_port = 0;                ///< poses and buttons go to the record server there too; 0: to none
  std::shared_ptr<const ButtonBoard> board;  ///< buttons beside the device's own; may be null
  std::filesystem::path record;              ///< every tick is written to this file; empty: no recording
};

/// Which lesson it is, for a window and a record server that must mean the same: of the case, the rubric, the module,
/// who does it, what is asked for, and the questions with the order of their answers. Never 0.
std::uint32_t lesson_number(const std::string& case_sha256, const SessionOptions& options);

/// The results of a session.
struct SessionResult {
  haptics::RecordingHeader header;    ///< case, shape, device, and the parameters
  std::map<int, std::string> shapes;  ///< of the case, by number
  haptics::RealtimeGrant grant;
  haptics::ServoStatistics statistics;
  std::vector<std::pair<std::string, std::uint64_t>> device_counts;
  std::uint64_t jumps = 0, gaps = 0;  ///< of the device, after which the force came back
  struct Second {                     ///< of the other hand
    std::vector<std::pair<std::string, std::uint64_t>> device_counts;
    std::uint64_t jumps = 0, gaps = 0, touching = 0;
    double most_force_n = 0;
    std::uint32_t faults = 0;
  };
  std::optional<Second> second;
  std::uint64_t frames_lost = 0;                    ///< frames that were not recorded, because the disk was too slow
  std::optional<haptics::DrillingOutcome> drilled;  ///< where the tool cuts
  std::optional<haptics::RecordedCutting> outcome;  ///< the same in mm, with the volume's hash
  double cpu_s = 0;                                 ///< of the servo thread, including the system calls of its sleeps
  double cpu_us_a_tick() const;
};

/// Of the other hand, those after which its force stayed zero; 0 where there is none.
std::uint32_t lasting_second_faults(const SessionResult& result);

/// A hand in a case: what is felt, the device, the tool, and the servo loop in its own thread. The caller constructs
/// it, starts it, calls write_frames() regularly while it is running(), and finishes it. A command calls write_frames()
/// 50 times a second, a window between two pictures.
class Session {
 public:
  /// Loads the case and makes the device, which may wait for a client and says so, a line at a time. Throws as
  /// FeltCase, make_device, make_tool, LiveSound and RecordingWriter do; 64 for a session without a clock that is too
  /// long to be kept.
  ///
  /// `stop` ends a wait and the loop, and must outlive the session. A patient that is given is not loaded, and only
  /// one session at a time may run on it; what was cut of it stays cut.
  Session(const SessionOptions& options, const std::atomic<bool>& stop,
          const std::function<void(const texts::Note&)>& say, std::shared_ptr<Patient> patient = nullptr);
  /// Waits for the loop's end. Without finish() the recording is lost.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Starts the loop, and returns when it is known what the system grants.
  const haptics::RealtimeGrant& start();
  bool running() const { return thread_.joinable() && !done_; }
  /// One tick in the calling thread, of a session that is stepped and watched; `seconds` does not end it. The frame is
  /// valid until the next call. Throws Error 74 where it cannot be recorded.
  const haptics::ServoFrame& step();
  /// Writes the frames that were recorded since the last call. Throws Error 74. Without a clock it does nothing,
  /// because all frames wait for finish().
  void write_frames();
  /// The same, and the frames themselves, valid until the next call; for a session that is watched.
  const std::vector<haptics::ServoFrame>& take_frames();
  /// Waits for the loop's end, and completes the recording. A session that was stopped is only shorter; its recording
  /// is kept. Throws Error 74.
  SessionResult finish();
  /// The frames that finish() took, for a session that is watched.
  const std::vector<haptics::ServoFrame>& last_frames() const { return frames_; }
  /// Of the other hand, as many as step(), take_frames() or finish() gave, of the same ticks; empty where there is
  /// none.
  const std::vector<haptics::ServoFrame>& second_frames() const { return second_frames_; }

  const haptics::RecordingHeader& header() const { return header_; }
  int tool_points() const;                                               ///< 0: a point at the tip alone
  const haptics::Drilling* drilling() const { return drilling_.get(); }  ///< null where nothing cuts
  /// May be called while it runs: the faults latched so far, and how long it has run.
  std::uint32_t faults() const { return servo_->faults(); }
  std::uint32_t second_faults() const { return second_ ? second_->faults() : 0; }
  double time_s() const { return double(servo_->ticks_done()) / options_.servo.rate_hz; }

 private:
  haptics::RecordingHeader header_of(const SessionOptions& options) const;
  device::DeviceScene scene_of(const SessionOptions& options, const device::WorkspaceParams& workspace,
                               const std::function<void(const texts::Note&)>& say);
  std::unique_ptr<device::Device> made_device(const SessionOptions& options,
                                              const std::function<void(const texts::Note&)>& say);
  std::unique_ptr<device::Device> made_second(const SessionOptions& options,
                                              const std::function<void(const texts::Note&)>& say);
  std::size_t queue_size() const;
  void drain();
  void run();

  const SessionOptions options_;
  const std::atomic<bool>& stop_;
  std::shared_ptr<Patient> patient_;
  double place_error_mm_ = 0;  // of the device itself, whatever lies before it
  std::unique_ptr<device::Device> device_, second_device_;
  haptics::RecordingHeader header_;
  std::unique_ptr<haptics::Drilling> drilling_;
  haptics::DevicePort port_;
  std::unique_ptr<haptics::Proxy> proxy_;    // or
  std::unique_ptr<haptics::ToolBelt> belt_;  // of the two one
  std::unique_ptr<haptics::RecordingWriter> recording_;
  std::uint64_t ticks_;
  haptics::FrameQueue queue_;
  std::unique_ptr<SecondHand> second_;
  std::optional<haptics::Servo> servo_;
  std::vector<haptics::ServoFrame> frames_, second_frames_;  // on their way from the queue to the disk
  haptics::RealtimeGrant grant_;
  std::unique_ptr<sound::LiveSound> sound_;
  double cpu_s_ = 0;
  std::atomic<bool> done_{false};
  std::thread thread_;
};

}  // namespace trephine::session
