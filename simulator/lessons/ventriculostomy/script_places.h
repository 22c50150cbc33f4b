// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "lessons/move_plan.h"
#include "lessons/ventriculostomy/head_frame.h"

namespace trephine::lessons {

/// The places of a script in a case. Ways over the skin are arcs of what a ray to the head's middle meets first.
class ScriptPlaces {
 public:
  ScriptPlaces(const ScriptScene& scene, const HeadFrame& frame, const ScriptAim& aim);

  /// Throws Error 65 as plan_head_moves does. Of a place on the skin the point on it; else the point itself.
  Vec3 find(const ScriptPlace& place);
  /// The skin in that direction from the middle of the head; throws Error 65 where nothing is felt there.
  Vec3 skin_towards(Vec3 direction) const;
  Vec3 direction_of(Vec3 point_mm) const;
  /// Points from one direction to the other, about a degree apart.
  std::vector<Vec3> directions_between(Vec3 from, Vec3 to) const;

  std::optional<Vec3> mark_mm, hole_mm;  ///< as the script goes on

 private:
  Vec3 named(const std::string& name) const;
  Vec3 over_skin(Vec3 from, Vec3 towards, double by_mm) const;
  const ScriptScene& scene_;
  const HeadFrame& frame_;
  AimMiss missed_;
};

}  // namespace trephine::lessons
