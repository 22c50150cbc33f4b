// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "haptics/proxy_body.h"

namespace trephine::haptics {

/// The lock of the orientation of a tool of many points [Rizzi, chapter 5, Tables V and VI]; it holds while
/// HapticState::locked.
class ToolLock {
 public:
  explicit ToolLock(const Tool& tool)
      : may_(tool.search == ToolParams::Search::both && tool.lock_distance_mm > 0),
        distance_mm_(tool.lock_distance_mm) {}
  void begin_frame() { any_collided_ = false; }
  /// Notes what collided, and begins the lock where the first points that collide from either end are further apart
  /// than the lock's distance, while the tool is turned into the wall of one of them; true where it began. `may_begin`:
  /// nothing forbids it.
  bool begin(ProxyGround& ground, const ToolBody& body, const ToolBody::Meeting& m, Vec3 turn, bool may_begin);
  /// Ends the lock where the device turns away from its wall, or `out`. From time to time it also asks whether the turn
  /// is `barred()`, and ends the lock where it is free.
  template <class Barred>
  void end(HapticState& state, Vec3 device_axis, bool out, const Barred& barred) {
    if (!state.locked) return;
    if (!(dot(normal_, device_axis) > dot_ + 1e-12) && !out && (++locked_for_ % frames_between_looks != 0 || barred()))
      return;
    state.locked = false;
    state.events |= haptic_event::unlocked;
  }

 private:
  static constexpr int frames_between_looks = 8;
  struct Collided {  // in this frame
    int point;
    Vec3 at_mm, normal;
  };
  bool may_;
  double distance_mm_;
  Vec3 normal_;
  double dot_ = 0;
  int locked_for_ = 0;  // frames
  Collided from_tip_, from_tail_;
  bool any_collided_ = false;
};

}  // namespace trephine::haptics
