// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cmath>

#include "base/vec3.h"

namespace trephine::meshing {

/// Sum of weighted squared distances to planes and points [Garland1997]: x^T A x + 2 b^T x + c. x is measured from a
/// centre that the caller keeps; near the surface float32 is precise enough for the coefficients.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec3 b;
  double c = 0;

  /// Adds a plane through the centre.
  void add_plane(Vec3 unit_normal, double weight) {
    const Vec3 n = unit_normal * weight;
    xx += n.x * unit_normal.x;
    xy += n.x * unit_normal.y;
    xz += n.x * unit_normal.z;
    yy += n.y * unit_normal.y;
    yz += n.y * unit_normal.z;
    zz += n.z * unit_normal.z;
  }
  /// Adds the centre itself.
  void add_point(double weight) {
    xx += weight;
    yy += weight;
    zz += weight;
  }
  void add(const Quadric& q) {
    xx += q.xx;
    xy += q.xy;
    xz += q.xz;
    yy += q.yy;
    yz += q.yz;
    zz += q.zz;
    b += q.b;
    c += q.c;
  }
  Vec3 times(Vec3 p) const {
    return {xx * p.x + xy * p.y + xz * p.z, xy * p.x + yy * p.y + yz * p.z, xz * p.x + yz * p.y + zz * p.z};
  }
  double at(Vec3 p) const { return dot(p, times(p) + b * 2) + c; }
  /// Moves the centre by d.
  void shift(Vec3 d) {
    const Vec3 ad = times(d);
    c += dot(d, ad + b * 2);
    b += ad;
  }
  /// The sum of the weights (planes count once, points three times).
  double weight() const { return xx + yy + zz; }
  /// The point where the sum is least; returns false where it is ill-conditioned.
  bool minimum(Vec3& p) const {
    const double c00 = yy * zz - yz * yz, c01 = xz * yz - xy * zz, c02 = xy * yz - xz * yy;
    const double determinant = xx * c00 + xy * c01 + xz * c02;
    const double trace = xx + yy + zz;
    if (!(std::abs(determinant) > 1e-10 * trace * trace * trace)) return false;
    const double c11 = xx * zz - xz * xz, c12 = xy * xz - xx * yz, c22 = xx * yy - xy * xy;
    p = Vec3{c00 * b.x + c01 * b.y + c02 * b.z, c01 * b.x + c11 * b.y + c12 * b.z, c02 * b.x + c12 * b.y + c22 * b.z} *
        (-1 / determinant);
    return true;
  }
};

/// A quadric in float32, half the size.
struct StoredQuadric {
  std::array<float, 10> v{};
  StoredQuadric() = default;
  explicit StoredQuadric(const Quadric& q)
      : v{float(q.xx), float(q.xy),  float(q.xz),  float(q.yy),  float(q.yz),
          float(q.zz), float(q.b.x), float(q.b.y), float(q.b.z), float(q.c)} {}
  Quadric loaded() const { return {v[0], v[1], v[2], v[3], v[4], v[5], {v[6], v[7], v[8]}, v[9]}; }
};

}  // namespace trephine::meshing
