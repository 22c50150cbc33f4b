// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "base/params.h"
#include "contact/contact.h"

namespace trephine {

/// A simulated hand's task: to come from one side, press on the first surface that it meets there, and move over it in
/// a circle.
struct HandPathParams {
  std::array<double, 3> from{0, 0, 1};
  double depth_mm = 1, radius_mm = 15, approach_mm = 10;
  template <class V>
  static void describe(V& v) {
    using P = HandPathParams;
    v.numbers(&P::from, "from", Range{-1, 1}, "Direction, LPS, from which the hand comes to the volume's middle.");
    v.number(&P::depth_mm, "depth_mm", Range{-50, 50}, "How far behind the surface the hand aims.");
    v.number(&P::radius_mm, "radius_mm", Range{0, 200}, "Of the circle that it follows.");
    v.number(&P::approach_mm, "approach_mm", Range{0, 200}, "How far before the surface it begins.");
  }
};

struct HandPath {
  std::vector<Vec3> points_mm;
  std::size_t loop_from = 0;  ///< where the circle begins
  int shape = 0;              ///< that it goes over
};

/// Throws Error 78 where the direction is zero, or no touchable surface lies that way.
HandPath path_over(const ContactVolume& contact, const TouchableFaces& faces, const HandPathParams& params);

}  // namespace trephine
