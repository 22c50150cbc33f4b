// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A session of the simulator that is moved by its caller, tick by tick.
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/params.h"
#include "session/session.h"

namespace trephine::python {

/// What a hand holds, and how it is felt: the options of `trephine-sim servo`, by the same names.
struct HandParams {
  std::string shape, lesson, participant = "anonymous", task;
  double rate_hz = haptics::ServoParams().rate_hz;
  bool knows_across = false;
  contact::ContactParams contact;
  haptics::ForceParams force;
  haptics::PortParams port;
  haptics::FreeParams free;
  haptics::ToolParams tool;
  haptics::ShaftParams shaft;
  haptics::DrillingParams drilling;
  drill::DrillParams law;
  template <class V>
  static void describe(V& v) {
    using P = HandParams;
    v.text(&P::shape, "shape", "The only shape that is felt; empty: all of the case.");
    v.text(&P::lesson, "lesson", "The lesson whose tools are in hand, in place of `tool`; empty: none.");
    v.text(&P::participant, "participant", "An anonymous token, of a lesson.");
    v.text(&P::task, "task", "What is asked for in the lesson; empty: what is usual in the case.");
    v.number(&P::rate_hz, "rate_hz", Range{50, 20000}, "Ticks in each second.");
    v.flag(&P::knows_across, "knows_across", "Each pose says how the tool is turned about its axis.");
    v.all_of(&P::contact);
    v.all_of(&P::force);
    v.all_of(&P::port);
    v.all_of(&P::free);
    v.all_of(&P::tool);
    v.all_of(&P::shaft);
    v.all_of(&P::drilling);
    v.all_of(&P::law);
  }
};

/// The device that its caller places.
class PlacedDevice : public device::Device {
 public:
  explicit PlacedDevice(bool knows_across) : knows_across_(knows_across) {}
  double damping_n_s_per_mm() const override { return 0; }
  bool read(double, device::DeviceReading& out) override {
    out = now;
    return true;
  }
  void send(Vec3) override {}
  void tell(const device::DeviceNews& news) override { torque_n_mm = news.torque_n_mm; }
  bool knows_across() const override { return knows_across_; }

  device::DeviceReading now;
  Vec3 torque_n_mm;

 private:
  bool knows_across_;
};

/// Ticks are those of the servo loop, so equal poses give equal bits. One thread at a time may use it: others get
/// std::runtime_error.
class Hand {
 public:
  /// Throws as session::Session does, which loads the case; 65 where the case holds no such lesson.
  Hand(const std::string& folder, const HandParams& params, const std::string& record);
  /// The patient as the case has it, and a new session. A recording that is not finished is lost.
  void reset(const std::string& record);
  haptics::ServoFrame step(const device::DeviceReading& pose);
  std::vector<haptics::ServoFrame> run(const std::vector<device::DeviceReading>& poses, const Progress& progress);
  /// Ends the session and completes its recording; then only reset() may be called. Null where it has ended.
  std::optional<session::SessionResult> finish();
  /// Ends it without its recording.
  void drop();

  /// To be held while what a tick may change is read: the volume and the header. Throws where another thread has it.
  std::unique_lock<std::mutex> alone();
  const haptics::RecordingHeader& header() const { return header_; }
  bool knows_across() const { return knows_across_; }
  const cases::LoadedCase& loaded() const { return patient_->felt.loaded; }
  const session::Patient& patient() const { return *patient_; }
  /// On the hand, about the tip; zero where the session has ended.
  Vec3 torque_n_mm();
  /// Of 1/255 voxel, what was removed of the shape so far, or by the end of the session.
  std::int64_t removed_units(int shape);

 private:
  void begin(const std::string& record);
  /// The session that was there, which is then the caller's.
  std::unique_ptr<session::Session> end();
  session::Session& session();
  session::SessionOptions options_of(const HandParams& params) const;

  const std::atomic<bool> stop_{false};
  std::shared_ptr<session::Patient> patient_;
  std::vector<std::int16_t> uncut_;  // empty where nothing cuts
  session::SessionOptions options_;
  std::unique_ptr<session::Session> session_;
  PlacedDevice* device_ = nullptr;             // the session's
  std::map<int, std::int64_t> removed_units_;  // by shape, of the session that has ended
  haptics::RecordingHeader header_;
  const bool knows_across_;
  std::mutex used_;
};

}  // namespace trephine::python
