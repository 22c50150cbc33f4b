// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/params.h"
#include "device/device.h"

namespace trephine::device {

/// Arm, grip and device as one mass, which a spring and a damper pull along a path with a person's delay and tremor.
/// The loop is closed: the force that the servo sends moves the hand that the servo reads, so stability is tested for
/// real.
struct HandParams {
  double mass_kg = 0.2, device_damping_n_s_per_mm = 0.002;
  double arm_stiffness_n_per_mm = 0.4, arm_damping_n_s_per_mm = 0.004;
  double delay_s = 0.1, tremor_mm = 0.02, tremor_hz = 9;
  double speed_mm_per_s = 20;
  template <class V>
  static void describe(V& v) {
    using P = HandParams;
    v.number(&P::mass_kg, "mass_kg", Range{0.005, 10}, "Mass of hand and device together.");
    v.number(&P::device_damping_n_s_per_mm, "device_damping_n_s_per_mm", Range{0, 1}, "The device's own damping.");
    v.number(&P::arm_stiffness_n_per_mm, "arm_stiffness_n_per_mm", Range{0, 10}, "How firmly the arm follows its aim.");
    v.number(&P::arm_damping_n_s_per_mm, "arm_damping_n_s_per_mm", Range{0, 1}, "Damping of arm and grip.");
    v.number(&P::delay_s, "delay_s", Range{0, 1}, "Delay with which the arm follows the aim.");
    v.number(&P::tremor_mm, "tremor_mm", Range{0, 5}, "Amplitude of the aim's tremor.");
    v.number(&P::tremor_hz, "tremor_hz", Range{0.1, 50}, "Frequency of the tremor; two others lie beside it.");
    v.number(&P::speed_mm_per_s, "speed_mm_per_s", Range{0, 1e5}, "Speed of the aim along its path.");
  }
};

/// The mass itself, for devices whose aim goes other ways.
struct HandBody {
  Vec3 position_mm, velocity, force_n;
  double force_age_s = 0;
  /// Moves for `part_s`, at most a millisecond, towards the aim.
  void pull(const HandParams& params, const ForceHold& hold, Vec3 to_mm, double part_s);
  void feel(Vec3 force) {
    force_n = force;
    force_age_s = 0;
  }
};
/// Moves the aim by the tremor of that time.
void add_tremor(const HandParams& params, double time_s, Vec3& aim_mm);

class SimulatedHand : public Device {
 public:
  /// `path_mm` has at least one point. The aim goes along it, and then along the part from `loop_from` again and again.
  SimulatedHand(const HandParams& params, std::vector<Vec3> path_mm, std::size_t loop_from = 0);
  double damping_n_s_per_mm() const override { return params_.device_damping_n_s_per_mm; }
  bool read(double dt_s, DeviceReading& out) override;
  void send(Vec3 force_n) override;

  ForceHold hold;           ///< what it does while no force is sent
  Vec3 axis{0, 0, 1};       ///< of the tool that it holds and does not turn
  bool drills = false;      ///< it marks an incision at the start, then holds the pedal down
  double feed_force_n = 0;  ///< while the arm pulls more than that it waits on its path; 0: never
  /// What the arm presses with along the tool where something is touched, until its path's end; 0: see feed_force_n.
  double press_n = 0;

 private:
  Vec3 aim(double path_s, double time_s) const;
  Vec3 pressed(Vec3 on_path) const;
  HandParams params_;
  std::vector<Vec3> path_mm_;
  std::vector<double> length_mm_;  ///< from the path's begin to each point
  double loop_begin_mm_ = 0;
  HandBody body_;
  double time_s_ = 0, path_s_ = 0;
};

}  // namespace trephine::device
