// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>

#include "base/vec3.h"

namespace trephine {

/// Sum of weighted squared distances to planes and points (Garland, Heckbert 1997): x^T A x + 2 b^T x + c.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec3 b;
  double c = 0;

  void add_plane(Vec3 unit_normal, Vec3 point, double weight) {
    const Vec3 n = unit_normal * weight;
    const double d = -dot(unit_normal, point);
    xx += n.x * unit_normal.x;
    xy += n.x * unit_normal.y;
    xz += n.x * unit_normal.z;
    yy += n.y * unit_normal.y;
    yz += n.y * unit_normal.z;
    zz += n.z * unit_normal.z;
    b += n * d;
    c += weight * d * d;
  }
  void add_point(Vec3 p, double weight) {
    xx += weight;
    yy += weight;
    zz += weight;
    b += p * -weight;
    c += weight * dot(p, p);
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
  double at(Vec3 p) const {
    return p.x * (xx * p.x + 2 * (xy * p.y + xz * p.z + b.x)) + p.y * (yy * p.y + 2 * (yz * p.z + b.y)) +
           p.z * (zz * p.z + 2 * b.z) + c;
  }
  /// Where the sum is least; false where that is ill-conditioned.
  bool minimum(Vec3& p) const {
    const double c00 = yy * zz - yz * yz, c01 = xz * yz - xy * zz, c02 = xy * yz - xz * yy;
    const double determinant = xx * c00 + xy * c01 + xz * c02;
    const double trace = xx + yy + zz;
    if (!(std::abs(determinant) > 1e-12 * trace * trace * trace)) return false;
    const double c11 = xx * zz - xz * xz, c12 = xy * xz - xx * yz, c22 = xx * yy - xy * xy;
    p = Vec3{c00 * b.x + c01 * b.y + c02 * b.z, c01 * b.x + c11 * b.y + c12 * b.z, c02 * b.x + c12 * b.y + c22 * b.z} *
        (-1 / determinant);
    return true;
  }
};

}  // namespace trephine
