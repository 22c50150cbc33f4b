// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/vec3.h"
#include "cases/material.h"
#include "contact/constraints.h"
#include "haptics/grain.h"
#include "tissue/relaxation.h"

namespace trephine::haptics {

/// A surface that holds a tool back, and how it feels.
struct HeldSurface {
  int shape = 0, face = 0, into = 0;  ///< face: 1 front, 2 back
  cases::CaseFace feel;
  Grain grain;
  Vec3 arm_mm;  ///< from the tip to where it presses
  Vec3 at_mm;   ///< where it was touched
};

/// The up to three surfaces that hold a proxy back in a frame, as planes for one point of it, and what the hand feels
/// of them. It allocates nothing; equal calls give equal bits.
class HeldSurfaces {
 public:
  static constexpr int max_count = 3;
  /// Cosine between normals of one curved surface, not of two that meet in an edge; and of facets of a mesh, whose
  /// edges are felt as they are.
  static constexpr double same_surface = 0.8, same_facet = 0.98;

  void clear();
  int count() const { return count_; }
  /// Whether the last solve() found the point nearest to the device.
  bool solved() const { return solved_; }
  void leave_unsolved() { solved_ = false; }
  const contact::Plane& plane(int n) const { return planes_[n]; }
  const HeldSurface& surface(int n) const { return held_[n]; }
  double pressure_mm(int n) const { return nearest_.pressure_mm[n]; }
  Vec3 nearest_mm() const { return nearest_.point_mm; }  ///< to the device, before all planes

  bool knows(Vec3 normal, int shape) const;
  /// The place of a plane of that surface of the shape, or else the next that is free; max_count where none is.
  int place_of(Vec3 normal, int shape) const;
  void set(int place, const contact::Plane& plane, const HeldSurface& surface);
  /// Puts the plane in the place of its surface, where the one that reaches further counts; or in a free one, or in
  /// that of one that does not press. Returns the place, -1 where all of them press.
  int put(const contact::Plane& plane, const HeldSurface& surface);
  void move_arm(int place, Vec3 arm_mm) { held_[place].arm_mm = arm_mm; }
  /// Finds the point before all planes that is nearest to the device, and how much each presses.
  bool solve(Vec3 device_mm);
  bool nearest_to(Vec3 from_mm, contact::Nearest& out) const {
    return contact::nearest_before(planes_, count_, from_mm, out);
  }
  bool presses_alone(int place) const;
  bool any_presses() const;

  struct Felt {
    Vec3 force_n, torque_n_mm;  ///< on the hand; the torque about the tip
    Vec3 normal;                ///< of the surface that presses most
    int shape = 0, face = 0;    ///< its
    int count = 0;              ///< of the surfaces that press
  };
  /// Each plane's spring and damper along its normal, which never pull, and the spring along the way that friction
  /// held. Where nothing is solved, in a corner that three planes do not describe, the spring of the last plane alone.
  /// Of two that press alike the one of the shape `named` is named, so that the name does not flicker. What of a
  /// shape's springs has relaxed is left out, and noted.
  Felt felt(Vec3 proxy_mm, Vec3 device_mm, Vec3 velocity_mm_s, int named, tissue::Relaxations& relaxing) const;

 private:
  void relax(Vec3 slid_mm, double pressure_mm, double* push_n, tissue::Relaxations& relaxing) const;
  bool is_same(int place, Vec3 normal, int shape) const;
  contact::Plane planes_[max_count];
  HeldSurface held_[max_count];
  contact::Nearest nearest_;
  int count_ = 0;
  bool solved_ = false;
};

}  // namespace trephine::haptics
