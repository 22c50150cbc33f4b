// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>

#include "surface/point_triangle.h"

namespace trephine::surface {

/// A triangle for many nearest points: what does not depend on the point is computed once. nearest() gives the bits of
/// nearest_on_triangle.
class TriangleFrame {
 public:
  TriangleFrame(Vec3 a, Vec3 b, Vec3 c)
      : a_(a), b_(b), c_(c), ab_(b - a), bc_(c - b), ca_(a - c), n_(cross(ab_, -ca_)) {
    ab2_ = dot(ab_, ab_);
    bc2_ = dot(bc_, bc_);
    ca2_ = dot(ca_, ca_);
    n2_ = dot(n_, n_);
    const double longest2 = std::max(ab2_, std::max(bc2_, ca2_));
    flat_ = !(n2_ > 1e-20 * longest2 * longest2);
    off_ab_ = cross(n_, ab_);
    off_bc_ = cross(n_, bc_);
    off_ca_ = cross(n_, ca_);
  }

  ClosestPoint nearest(Vec3 p) const {
    const Vec3 ap = p - a_;
    // On which side p lies of each plane that contains an edge and is perpendicular to the triangle.
    bool out_ab = true, out_bc = true, out_ca = true;
    if (!flat_) {
      out_ab = dot(off_ab_, ap) < 0;
      out_bc = dot(off_bc_, p - b_) < 0;
      out_ca = dot(off_ca_, ap) < 0;
      if (!out_ab && !out_bc && !out_ca) {
        const double height = dot(n_, ap);
        return {height * height / n2_, p - n_ * (height / n2_), 6};
      }
    }
    // The nearest point lies on an edge that p is outside of. Where it is the corner of two edges, p is outside at
    // least one of them.
    ClosestPoint best;
    best.squared_mm2 = 1e300;
    if (out_ab) take_segment(p, a_, ab_, ab2_, 0, 3, 1, best);
    if (out_bc) take_segment(p, b_, bc_, bc2_, 1, 4, 2, best);
    if (out_ca) take_segment(p, c_, ca_, ca2_, 2, 5, 0, best);
    return best;
  }

 private:
  // The nearest point of the segment from a to a + d. The feature is the start, `edge` or the end.
  static void take_segment(Vec3 p, Vec3 a, Vec3 d, double length2, int start, int edge, int end, ClosestPoint& best) {
    const double along = dot(p - a, d);
    const bool at_start = !(along > 0), at_end = !at_start && along >= length2;
    const Vec3 q = at_start ? a : at_end ? a + d : a + d * (along / length2);
    const Vec3 to = p - q;
    const double squared = dot(to, to);
    if (squared < best.squared_mm2) best = {squared, q, at_start ? start : at_end ? end : edge};
  }

  Vec3 a_, b_, c_, ab_, bc_, ca_, n_, off_ab_, off_bc_, off_ca_;
  double ab2_, bc2_, ca2_, n2_;
  bool flat_;  ///< a sliver, which counts as its edges
};

}  // namespace trephine::surface
