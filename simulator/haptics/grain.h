// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cases/material.h"

namespace trephine::haptics {

/// Friction that depends on the direction in which a tool slides, as over fibres. The friction ratios of a face are
/// those along its grain; across it they are `across_grain_ratio` times as large, so that the friction which the
/// surface can hold is an ellipse and not a circle. A tool that slides feels, of all friction in that ellipse, the one
/// that takes most energy from its motion (the associated sliding rule [Michalowski1978] [Goyal1991]): a tool that is
/// led aslant is turned towards the easier way. Friction never gives energy to a hand, and what lies within the ellipse
/// is a spring that gives back what was put into it.
///
/// The grain is a direction in the patient. On a surface that it leaves, the ellipse is that in which the surface cuts
/// an ellipsoid about the grain; where it stands upright on the surface, friction is that across it in all directions.
class Grain {
 public:
  Grain() = default;  ///< none: friction is the same in all directions
  Grain(const cases::MaterialParams& material, const cases::CaseFace& face);
  bool any() const { return any_; }
  /// Of two surfaces that are touched at once: at share 0 this one, at 1 the other.
  Grain mixed(const Grain& other, double share) const;
  /// As long as the way along the grain that friction holds as well. `normal`: the surface's; zero: the way goes along
  /// an edge, where only its own direction counts.
  double length_mm(Vec3 way_mm, Vec3 normal) const;
  /// What friction holds back of a way that is longer than `limit_mm`, the radius of the ellipse along the grain: the
  /// place on the ellipse's edge that is nearest to the way's end.
  Vec3 held_back_mm(Vec3 way_mm, Vec3 normal, double limit_mm) const;

 private:
  double product(Vec3 a, Vec3 b) const {
    return dot(a, squared_.column[0] * b.x + squared_.column[1] * b.y + squared_.column[2] * b.z);
  }
  bool any_ = false;
  Mat3 squared_;  // by which a way's squared length counts: 1 along the grain
};

}  // namespace trephine::haptics
