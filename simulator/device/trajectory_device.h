// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <vector>

#include "device/device.h"

namespace trephine::device {

/// A pose in time; between two poses the tool moves straight.
struct TrajectoryPoint {
  double time_s = 0;
  DeviceReading reading;
};

/// Plays back a path whatever the force is (an open loop). After the path's end the tool stays there.
class Trajectory : public Device {
 public:
  /// At least one point; times ascend.
  explicit Trajectory(std::vector<TrajectoryPoint> points) : points_(std::move(points)) {}
  double damping_n_s_per_mm() const override { return 0; }
  bool read(double dt_s, DeviceReading& out) override;
  void send(Vec3) override {}

 private:
  std::vector<TrajectoryPoint> points_;
  std::size_t next_ = 0;
  double time_s_ = 0;
};

/// Reads lines "time_s x_mm y_mm z_mm [ax ay az [buttons]]" (separated by spaces or commas; # begins a comment); an
/// axis is normalized. Throws Error 66; 65 with the line's number: numbers that are missing or not finite, times that
/// do not ascend, an axis of no length.
std::vector<TrajectoryPoint> read_trajectory(const std::filesystem::path& file);

}  // namespace trephine::device
