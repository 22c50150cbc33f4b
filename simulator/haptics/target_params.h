// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "base/params.h"

namespace trephine::haptics {

/// A target that runs over the surface for a hand to follow (session/moving_target.h).
struct TargetParams {
  bool target = false;
  double target_speed_mm_per_s = 10, target_radius_mm = 15, target_begins_s = 3;
  std::array<double, 3> target_from{0, 0, 1};
  template <class V>
  static void describe(V& v) {
    using P = TargetParams;
    v.flag(&P::target, "target", "A target runs over the surface in a circle, for the hand to follow.");
    v.number(&P::target_speed_mm_per_s, "target_speed_mm_per_s", Range{0.1, 1000}, "Its speed along its path.");
    v.number(&P::target_radius_mm, "target_radius_mm", Range{0.5, 200}, "Radius of its circle.");
    v.number(&P::target_begins_s, "target_begins_s", Range{0, 3600}, "Time at which it sets off.");
    v.numbers(&P::target_from, "target_from", Range{-1, 1},
              "Direction, LPS, from which the circle is laid onto the surface, about the volume's centre.");
  }
};

}  // namespace trephine::haptics
