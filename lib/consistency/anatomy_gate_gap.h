// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "consistency/accepted_places.h"
#include "mask/bits.h"

namespace trephine::consistency {

/// How two anatomies that must not touch lie to each other.
struct Clearance {
  /// The part of the first anatomy that lies where it must not: its volume, and the depth of its voxel that is farthest
  /// from where it may lie (0: there is none; 40 also stands for more).
  double wrong_ml = 0, depth_mm = 0;
  Vec3 deepest_mm;
  /// The least distance of the two surfaces, and where it is; 1e6 where it is above 5 mm; 0 where the surfaces cross.
  double gap_mm = 1e6;
  Vec3 gap_at_mm;
  /// The area of the first surface that is nearer than the required distance.
  double near_mm2 = 0;
  /// Where a person would have to accept it (consistency/accepted_places.h); empty where it is too wide for that.
  std::vector<Vec3> places_mm;
};

enum class Relation { inside, apart };

/// Checks `one` against `other` (fields on one raster, else Error 65): it must lie inside of it, or share nothing with
/// it. The surface of a field consists of triangles in each cell between the points where the field crosses 0 on the
/// cell's edges and the mean of these points. The nearest places are found by these means; there, the distance from
/// points of one surface to the triangles of the other is exact. near_mm2 is the area of the surface nearer than
/// asked_mm; where this is more than 4,096 cells, it is estimated from that many of them. What lies where surfaces are
/// not compared does not count. The result has the same bits whatever the thread count.
Clearance clearance(const grid::Field& one, const grid::Field& other, Relation relation, double asked_mm,
                    const NotCompared& not_compared = {}, const Progress& progress = {});

}  // namespace trephine::consistency
