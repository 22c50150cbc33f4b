// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/vec3.h"

namespace trephine::device {

/// A hand that follows a goal as a mass on a spring with a damper, and feels the force: a tool that is led into bone
/// presses no harder than that hand pulls. For devices without a force of their own: mouse, gamepad, 3D mouse.
class LedHand {
 public:
  struct Spring {
    double mass_kg = 0.2, stiffness_n_per_mm = 0.4, damping_n_s_per_mm = 0.008;
    double max_n = 2.2;  ///< it never pulls harder
  };
  LedHand(const Spring& spring, Vec3 begin_mm) : spring_(spring), position_mm_(begin_mm) {}

  /// Follows the goal for that time, at most 0.1 s of it; it may pull as hard as min_most_n whatever its spring says.
  /// Neither allocates nor waits.
  void follow(Vec3 goal_mm, double span_s, double min_most_n = 0);
  /// The force on the hand from now on.
  void feel(Vec3 force_n) { force_n_ = force_n; }
  /// It is there at once, at rest, and feels nothing.
  void put(Vec3 at_mm);
  Vec3 position_mm() const { return position_mm_; }
  /// How far behind its goal it can be held before it pulls its most.
  double reach_mm() const { return spring_.max_n / spring_.stiffness_n_per_mm; }

 private:
  Spring spring_;
  Vec3 position_mm_, velocity_, force_n_;
};

/// The axis on its way to another: most of a turn is done in 50 ms. Unit.
Vec3 turned_towards(Vec3 axis, Vec3 goal, double span_s);

}  // namespace trephine::device
