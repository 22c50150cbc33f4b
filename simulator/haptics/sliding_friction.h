// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/vec3.h"
#include "haptics/held_surfaces.h"

namespace trephine::haptics {

/// Static and dynamic friction on the way of a proxy along surfaces, as a cone about what holds it back [Ruspini1997].
class SlidingFriction {
 public:
  /// On the way from there to the point nearest to the device, on the surface of that plane. False where friction holds
  /// all of it; else the goal is the way's end, short by what friction holds back.
  bool slide(const HeldSurfaces& surfaces, int plane, Vec3 from_mm, Vec3 device_mm, Vec3& goal_mm);
  void rest() { sliding_ = false; }
  void pass(double dt_s) { since_slid_s_ += dt_s; }

 private:
  bool slides(const cases::CaseFace& feel, double length_mm, double depth_mm);
  bool sliding_ = false;
  double since_slid_s_ = 0;
};

}  // namespace trephine::haptics
