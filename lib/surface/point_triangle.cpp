// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/point_triangle.h"

#include <algorithm>

namespace trephine::surface {
namespace {

// The nearest point of the segment from a to a + d. The feature is the start, `edge` or the end.
void take_segment(Vec3 p, Vec3 a, Vec3 d, double length2, int start, int edge, int end, ClosestPoint& best) {
  const double along = dot(p - a, d);
  const bool at_start = !(along > 0), at_end = !at_start && along >= length2;
  const Vec3 q = at_start ? a : at_end ? a + d : a + d * (along / length2);
  const Vec3 to = p - q;
  const double squared = dot(to, to);
  if (squared < best.squared_mm2) best = {squared, q, at_start ? start : at_end ? end : edge};
}

}  // namespace

ClosestPoint nearest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, bc = c - b, ca = a - c, n = cross(ab, -ca);
  const double ab2 = dot(ab, ab), bc2 = dot(bc, bc), ca2 = dot(ca, ca), n2 = dot(n, n);
  const double longest2 = std::max(ab2, std::max(bc2, ca2));
  const Vec3 ap = p - a;
  // On which side p lies of each plane that contains an edge and is perpendicular to the triangle.
  bool out_ab = true, out_bc = true, out_ca = true;
  if (n2 > 1e-20 * longest2 * longest2) {
    out_ab = dot(cross(n, ab), ap) < 0;
    out_bc = dot(cross(n, bc), p - b) < 0;
    out_ca = dot(cross(n, ca), ap) < 0;
    if (!out_ab && !out_bc && !out_ca) {
      const double height = dot(n, ap);
      return {height * height / n2, p - n * (height / n2), 6};
    }
  }
  // The nearest point lies on an edge that p is outside of. Where it is the corner of two edges, p is outside at least
  // one of them.
  ClosestPoint best;
  best.squared_mm2 = 1e300;
  if (out_ab) take_segment(p, a, ab, ab2, 0, 3, 1, best);
  if (out_bc) take_segment(p, b, bc, bc2, 1, 4, 2, best);
  if (out_ca) take_segment(p, c, ca, ca2, 2, 5, 0, best);
  return best;
}

}  // namespace trephine::surface
