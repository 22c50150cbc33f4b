// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/vec3.h"

namespace trephine::surface {

/// The point of a triangle that is nearest to a given point.
struct ClosestPoint {
  double squared_mm2 = 0;
  Vec3 point;
  /// 0 to 2: on corner a, b, c; 3 to 5: on edge ab, bc, ca; 6: within.
  int feature = 6;
};

/// The point of triangle abc that is nearest to p; the triangle may be a segment or a point. Slivers whose height is
/// below 1e-10 of their longest edge count as their edges. The order of magnitude of the coordinates has no effect.
ClosestPoint nearest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c);

/// The same in two thirds of the time, for triangles that are not slivers ([Ericson2005], 5.1.5). Its last bits differ
/// from those of nearest_on_triangle, so one cannot replace the other without a change of results: measured distances
/// come from nearest_on_triangle, while decimation and smoothing are steered by this function.
struct PlaceOnTriangle {
  int feature = 6;  ///< as in ClosestPoint
  /// On edge ab: a + s (b - a); bc: b + s (c - b); ca: a + s (c - a); within: a + s (b - a) + t (c - a).
  double s = 0, t = 0;
};
inline PlaceOnTriangle place_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {0};
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {3, d1 / (d1 - d3)};
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {5, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return {4, (d4 - d3) / ((d4 - d3) + (d5 - d6))};
  const double share = 1 / (va + vb + vc);
  return {6, vb * share, vc * share};
}

inline Vec3 closest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const PlaceOnTriangle at = place_on_triangle(p, a, b, c);
  switch (at.feature) {
    case 0:
      return a;
    case 1:
      return b;
    case 2:
      return c;
    case 3:
      return a + (b - a) * at.s;
    case 4:
      return b + (c - b) * at.s;
    case 5:
      return a + (c - a) * at.s;
    default:
      return a + (b - a) * at.s + (c - a) * at.t;
  }
}

/// Squared distance to a triangle, and whether its closest point lies on the side across from a (or at one of that
/// side's ends): then `across` is 1 where that is nearer to b, 2 where to c; else 0.
inline double squared_from_corner(Vec3 p, Vec3 a, Vec3 b, Vec3 c, int& across) {
  const auto squared = [](Vec3 v) { return dot(v, v); };
  const PlaceOnTriangle at = place_on_triangle(p, a, b, c);
  across = 0;
  switch (at.feature) {
    case 0:
      return squared(p - a);
    case 1:
      across = 1;
      return squared(p - b);
    case 2:
      across = 2;
      return squared(p - c);
    case 3:
      return squared(p - a - (b - a) * at.s);
    case 4:
      across = at.s < 0.5 ? 1 : 2;
      return squared(p - b - (c - b) * at.s);
    case 5:
      return squared(p - a - (c - a) * at.s);
    default:
      return squared(p - a - (b - a) * at.s - (c - a) * at.t);
  }
}

}  // namespace trephine::surface
