// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <cstdint>
#include <vector>

#include "cases/case.h"
#include "contact/contact.h"
#include "device/simulated_hand.h"
#include "haptics/recording.h"
#include "lessons/lesson_script.h"

namespace trephine::lessons {

/// One movement of a scripted hand: along a path, or staying where it is.
struct HandMove {
  std::vector<Vec3> path_mm;  ///< none: the aim stays
  Vec3 axis{0, 0, 1};         ///< of the tool, from its tip to its tail
  int tool = 0;
  bool pedal = false;
  int command = haptics::belt_command::none;  ///< in the first tick of the movement
  double speed_mm_per_s = 100;
  double feed_force_n = 0;  ///< while the arm pulls more than that it waits on its path; 0: never
  double wait_s = 0;        ///< after the path's end
  bool on_time = false;     ///< then it is over; else it is only when the hand has arrived, or half a second later
  bool lost = false;        ///< the device is gone
};

/// Where places of a script are, and how the hand errs in finding them.
struct ScriptAim {
  double aim_noise_mm = 0;
  std::int64_t seed = 1;
  template <class V>
  static void describe(V& v) {
    using P = ScriptAim;
    v.number(&P::aim_noise_mm, "aim_noise_mm", Range{0, 100},
             "Standard deviation, along each axis, of how far the hand misses a place that the script names.");
    v.integer(&P::seed, "seed", Range{0, 1e9}, "Of the misses; the same seed gives the same session.");
  }
};

/// A question as a recording has it (haptics::AskedQuestion), with its right answer.
struct OfferedQuestion : haptics::AskedQuestion {
  std::string right;
};

struct ScriptScene {
  const cases::CaseManifest& manifest;
  const contact::ContactVolume& contact;
  std::vector<haptics::BeltToolParams> tools;
  std::uint64_t drilled = 0;  ///< the shapes that can be drilled, bit n for shape n
  std::vector<OfferedQuestion> questions = {};
};

/// A simulated hand that does one movement after the other; the loop is closed as with SimulatedHand.
class ScriptedHand : public device::Device {
 public:
  ScriptedHand(const device::HandParams& params, std::vector<HandMove> moves);
  double damping_n_s_per_mm() const override { return params_.device_damping_n_s_per_mm; }
  bool read(double dt_s, device::DeviceReading& out) override;
  void send(Vec3 force_n) override { body_.feel(force_n); }
  /// Set when all is done; ends the servo loop.
  const std::atomic<bool>& done() const { return done_; }

 private:
  void begin_move();
  bool advance(double part_s);
  const device::HandParams params_;
  const std::vector<HandMove> moves_;
  const device::ForceHold hold_;
  device::HandBody body_;
  Vec3 aim_mm_;
  std::size_t move_ = 0, corner_ = 0;
  double waited_s_ = 0, held_s_ = 0, time_s_ = 0;
  int ticks_of_move_ = 0;
  std::atomic<bool> done_{false};
};

}  // namespace trephine::lessons
