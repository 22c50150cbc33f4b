// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/vec3.h"

namespace trephine {

/// Where on a triangle a point's nearest point lies.
struct ClosestPoint {
  double squared_mm2 = 0;
  Vec3 point;
  /// 0 to 2: on corner a, b, c; 3 to 5: on edge ab, bc, ca; 6: within.
  int feature = 6;
};

/// The point of triangle abc (a segment or a point is one too) that is nearest to p. Slivers whose height is below
/// 1e-10 of their longest edge are taken for their edges. Not affected by the order of magnitude of the coordinates.
ClosestPoint nearest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c);

}  // namespace trephine
