// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/vec3.h"

namespace trephine::device {

struct DeviceReading {
  Vec3 tip_mm;
  Vec3 axis{0, 0, 1};  ///< unit, from the tool's tip to its tail
  std::uint32_t buttons = 0;
  Vec3 across{};  ///< unit, a direction across the axis that turns with the tool; zero where the device does not know
  bool silent = false;  ///< it gave no pose for too long; this is the last, and others may come
};

/// The results of a tick, for a device that shows them.
struct DeviceNews {
  double time_s = 0;  ///< time of the servo loop
  Vec3 proxy_mm;
  int touched = 0, inside = 0;
  std::uint32_t faults = 0;
  Vec3 torque_n_mm{};            ///< on the hand, about the tool's tip; to be held and let go as the force is
  Vec3 axis{0, 0, 1}, across{};  ///< as the tool is shown
  std::uint32_t events = 0;      ///< of this tick
  bool locked = false;           ///< the tool's orientation is
  int tool = 0;                  ///< in hand, of a session with several
};

/// The interface between the servo loop and a device. read, tell and send are called in the servo thread and may
/// neither allocate, lock, nor make a system call: a device with its own input or output has a thread for that.
class Device {
 public:
  virtual ~Device() = default;
  /// The device's own damping, which limits how stiff a wall may be (acceptance cases H2, H3).
  virtual double damping_n_s_per_mm() const = 0;
  /// The pose now, `dt_s` after the previous one (0: the first). Returns false where the device is lost.
  virtual bool read(double dt_s, DeviceReading& out) = 0;
  /// Sets the force on the hand from now on.
  virtual void send(Vec3 force_n) = 0;
  /// Other results of the tick; called before its send.
  virtual void tell(const DeviceNews&) {}
  /// Whether its readings say how the tool is turned about its axis (DeviceReading::across).
  virtual bool knows_across() const { return false; }
  /// How far the tool may really lie from where its poses say, mm, the expected error; 0: they say where it is.
  virtual double place_error_mm() const { return 0; }
  /// The device's counters by name; may be called from another thread.
  virtual std::vector<std::pair<std::string, std::uint64_t>> counts() const { return {}; }
};

/// What a device does with a force that is not renewed: it holds it for a time, then lets it decay, so that a stalled
/// simulator neither kicks nor keeps pushing.
struct ForceHold {
  double hold_s = 0.005, decay_s = 0.01;
  /// The share of the force that is left `age_s` after it was sent.
  double share(double age_s) const;
};

}  // namespace trephine::device
