// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/vec3.h"

namespace trephine {

struct DeviceReading {
  Vec3 tip_mm;
  Vec3 axis{0, 0, 1};  ///< unit, from the tool's tip to its tail
  std::uint32_t buttons = 0;
};

/// What a tick found, for a device that shows it to somebody.
struct DeviceNews {
  double time_s = 0;  ///< of the servo loop
  Vec3 proxy_mm;
  int touched = 0, inside = 0;
  std::uint32_t faults = 0;
};

/// What the servo loop sees of a device. read, tell and send come from the servo thread and may neither allocate, lock,
/// nor make a system call: a device with input or output of its own has a thread for that.
class Device {
 public:
  virtual ~Device() = default;
  /// Its own damping, which limits how stiff a wall may be (H2, H3).
  virtual double damping_n_s_per_mm() const = 0;
  /// The pose now, `dt_s` after the one before (0: the first). False where the device is lost.
  virtual bool read(double dt_s, DeviceReading& out) = 0;
  /// The force on the hand from now on.
  virtual void send(Vec3 force_n) = 0;
  /// What else the tick found, before its send.
  virtual void tell(const DeviceNews&) {}
  /// What it counted, by name; for another thread, too.
  virtual std::vector<std::pair<std::string, std::uint64_t>> counts() const { return {}; }
};

/// What a device does with a force that nobody renews: it holds it, then lets it decay, so that a stalled simulator
/// neither kicks nor pushes on.
struct ForceHold {
  double hold_s = 0.005, decay_s = 0.01;
  /// Share of the force that is left `age_s` after it was sent.
  double share(double age_s) const;
};

}  // namespace trephine
