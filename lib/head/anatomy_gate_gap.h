// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mask/bits.h"

namespace trephine::segmentation {

/// How two anatomies lie to each other that must not touch.
struct Clearance {
  /// What of the one lies where it must not: its volume, and of its voxels the one that is farthest from where it may
  /// lie, and how far (0: there is none; 40 stands for more).
  double wrong_ml = 0, depth_mm = 0;
  Vec3 deepest_mm;
  /// The least distance of the two surfaces, and where; 1e6 where it is above 5 mm; 0 where they cross each other.
  double gap_mm = 1e6;
  Vec3 gap_at_mm;
  /// Surface of the one that is nearer than was asked for.
  double near_mm2 = 0;
};

enum class Relation { inside, apart };

/// Of `one` against `other` (fields on one raster, else Error 65): it must lie inside of it, or share nothing with it.
/// The surface of a field is that of its cells: triangles between the points where it crosses 0 on the cell's edges and
/// their middle. The places where the two are nearest are found by the cells' middles; there the distance from points
/// of the one to the triangles of the other is exact. near_mm2: of the surface nearer than asked_mm; where that is more
/// than 4,096 cells, from so many of them. The same bits whatever the thread count.
Clearance clearance(const Field& one, const Field& other, Relation relation, double asked_mm,
                    const Progress& progress = {});

}  // namespace trephine::segmentation
