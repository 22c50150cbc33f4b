// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where a way through a haptic volume changes from one shape to another. Nothing here allocates or throws.
#include <algorithm>
#include <cmath>

#include "contact/felt_lattice.h"

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
struct Segment {
  Vec3 begin, end;
  double t0 = 0, t1 = 1;  ///< where that part begins and ends on the whole
};

/// The last change of shape on a way, and whether it ends there.
struct Crossing {
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

class ContactCell;

/// Walks the part of a segment, from t0 to t1, that lies in the cell `at` of more than one shape. The crossing goes on
/// from what it holds; true where the walk ends.
bool walk_cell(const ContactCell& cell, const Segment& segment, const int* at, double t0, double t1,
               const TouchableFaces& faces, Crossing& crossing);

/// Walks a clipped segment through the cells of a sub-voxel surface, as one that begins in `shape`.
Crossing walk_cells(const FeltLattice& felt, const Segment& segment, int shape, const TouchableFaces& faces);

/// Follows a way as ContactVolume::cross says, by the walk and on the surface of the lattice's parameters.
Contact cross_segment(const FeltLattice& felt, Vec3 start_mm, Vec3 end_mm, int start_shape, const TouchableFaces& faces,
                      ContactBox* known);

}  // namespace trephine::contact
