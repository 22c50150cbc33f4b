// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "base/params.h"
#include "contact/contact.h"

namespace trephine {

/// The task of a simulated hand: it comes from one side, presses on the first surface that it meets there, and moves
/// over it in a circle.
struct HandPathParams {
  std::array<double, 3> from{0, 0, 1};
  double depth_mm = 1, radius_mm = 15, approach_mm = 10;
  template <class V>
  static void describe(V& v) {
    using P = HandPathParams;
    v.numbers(&P::from, "from", Range{-1, 1}, "Direction, LPS, from which the hand approaches the volume's centre.");
    v.number(&P::depth_mm, "depth_mm", Range{-50, 50}, "How far behind the surface the hand aims.");
    v.number(&P::radius_mm, "radius_mm", Range{0, 200}, "Radius of the circle that the hand follows.");
    v.number(&P::approach_mm, "approach_mm", Range{0, 200}, "Distance before the surface at which the hand begins.");
  }
};

struct HandPath {
  std::vector<Vec3> points_mm;
  std::size_t loop_from = 0;  ///< where the circle begins
  int shape = 0;              ///< the shape over which it moves
};

/// Throws Error 78 where the direction is zero, or no touchable surface lies that way.
HandPath path_over(const ContactVolume& contact, const TouchableFaces& faces, const HandPathParams& params);

}  // namespace trephine
