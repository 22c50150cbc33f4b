// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean/zone_clearance.h"

#include <algorithm>

#include "surface/point_to_mesh.h"

namespace trephine {

ZoneClearance clearance_of(const BurrHole& hole, std::optional<Vec3> toward_mm, const TriMesh& zone) {
  constexpr double step_mm = 0.25;
  const PointToMesh surface(zone);
  const double radius_mm = 0.5 * hole.request.diameter_mm;
  double end_mm = hole.bone_thickness_mm;
  if (toward_mm) end_mm = std::max(end_mm, dot(*toward_mm - hole.position_mm, hole.direction));
  ZoneClearance least{1e9, hole.position_mm};
  const int steps = static_cast<int>(end_mm / step_mm) + 1;
  for (int n = 0; n <= steps; ++n) {
    const double along_mm = std::min(n * step_mm, end_mm);
    const Vec3 at = hole.position_mm + hole.direction * along_mm;
    const double mm = surface.signed_distance_mm(at) - (along_mm <= hole.bone_thickness_mm ? radius_mm : 0);
    if (mm < least.least_mm) least = {mm, at};
  }
  return least;
}

}  // namespace trephine
