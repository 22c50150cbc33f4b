// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <functional>
#include <string>

#include "base/params.h"
#include "device/device.h"
#include "surface/trimesh.h"

namespace trephine::session {

struct CalibrationParams {
  double calibration_hz = 1000, workspace_s = 8, pulse_n = 1, wall_s = 1.5;
  double first_stiffness_n_per_mm = 0.25, last_stiffness_n_per_mm = 20, wall_most_n = 3;
  bool in_real_time = true;
  template <class V>
  static void describe(V& v) {
    using P = CalibrationParams;
    v.number(&P::calibration_hz, "calibration_hz", Range{50, 20000}, "Ticks in each second.");
    v.number(&P::workspace_s, "workspace_s", Range{0.1, 600}, "For how long the device is led through its workspace.");
    v.number(&P::pulse_n, "pulse_n", Range{0.05, 20}, "Force of the short pulses that measure the latency.");
    v.number(&P::wall_s, "wall_s", Range{0.2, 60}, "For how long the device is pressed against each wall.");
    v.number(&P::first_stiffness_n_per_mm, "first_stiffness_n_per_mm", Range{0.01, 100},
             "Stiffness of the first wall.");
    v.number(&P::last_stiffness_n_per_mm, "last_stiffness_n_per_mm", Range{0.01, 1000}, "Stiffness of the last.");
    v.number(&P::wall_most_n, "wall_most_n", Range{0.05, 100}, "No wall presses harder.");
    v.flag(&P::in_real_time, "in_real_time", "Keep to the clock; without it, as fast as a simulated device goes.");
  }
  std::string fault() const {
    return last_stiffness_n_per_mm >= first_stiffness_n_per_mm
               ? ""
               : "last_stiffness_n_per_mm: must not be below first_stiffness_n_per_mm";
  }
};

/// What was measured of a device; negative where it could not be.
struct Calibration {
  double poses_hz = 0;             ///< how often its pose changed while it moved
  double gap_p99_ms = 0;           ///< between two poses
  double latency_ms = -1;          ///< from a force to the motion that it makes, without the time that the mass takes
  surface::Bounds workspace;       ///< mm, in the device's own frame
  double stable_n_per_mm = -1;     ///< the stiffest wall on which it came to rest
  double unstable_n_per_mm = -1;   ///< the first on which it did not
  double unpressed_n_per_mm = -1;  ///< the first that nobody pressed, which ended the walls
};

/// Measures a device that somebody holds, in the calling thread: lead it through its workspace; hold it still for the
/// pulses; then press it down, gently and steadily, against walls that become stiffer by an eighth each. A wall counts
/// as stable where it was pressed, gave the hand no energy on the whole, and the device was at rest at its end; one
/// that is not pressed is tried again twice. `say` tells the hand what to do. Throws Error 74 where the device is lost,
/// Cancelled.
Calibration calibrate(device::Device& device, const CalibrationParams& params, const std::atomic<bool>& stop,
                      const std::function<void(const std::string&)>& say);

}  // namespace trephine::session
