// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the sources of ContactVolume share. Nothing here allocates or throws.
#include <algorithm>
#include <cmath>

#include "contact/contact.h"

namespace trephine::contact {
namespace detail {

constexpr double farthest_mm = 1e9;

inline bool usable(Vec3 p) {
  return std::abs(p.x) <= farthest_mm && std::abs(p.y) <= farthest_mm && std::abs(p.z) <= farthest_mm;  // not for NaN
}

inline Vec3 between(Vec3 p, Vec3 q, double t) { return p + (q - p) * t; }

inline Vec3 within_cell(Vec3 p, int i, int j, int k) {
  return {std::clamp(p.x - i, 0.0, 1.0), std::clamp(p.y - j, 0.0, 1.0), std::clamp(p.z - k, 0.0, 1.0)};
}

}  // namespace detail

/// The part of a segment that lies in the lattice's box, in voxel indices.
struct ContactVolume::Segment {
  Vec3 begin, end;
  double t0 = 0, t1 = 1;  ///< where that part begins and ends on the whole
};

struct ContactVolume::Crossing {
  bool hit = false, passed = false;
  double t = 1;  ///< of the part
  int from = 0, into = 0;

  /// Notes that the shape changes at t; true where the walk ends there.
  bool change(int now, double at, const TouchableFaces& faces) {
    from = into;
    into = now;
    t = at;
    hit = (now != 0 && (faces.front >> now & 1)) || (from != 0 && (faces.back >> from & 1));
    passed = passed || !hit;
    return hit;
  }
};

}  // namespace trephine::contact
