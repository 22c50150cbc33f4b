// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "boolean/burr_hole.h"
#include "surface/trimesh.h"

namespace trephine::boolean {

/// How near a trajectory comes to a zone. Negative: it enters it.
struct ZoneClearance {
  double least_mm = 0;
  Vec3 at_mm;  ///< the place of the axis where it is nearest
};

/// The distance of the hole's wall through the bone, and of the line from the bone's outside on to its end, from a
/// closed surface, at places 0.25 mm apart. The line ends at `toward_mm` (projected onto the axis), or where the bone
/// does where nothing is aimed at. Throws Error 65 as PointToMesh, and where
/// `toward_mm` is more than 500 mm away.
ZoneClearance clearance_of(const BurrHole& hole, std::optional<Vec3> toward_mm, const surface::TriMesh& zone);

}  // namespace trephine::boolean
