// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean/zone_clearance.h"

#include <algorithm>

#include "base/error.h"
#include "surface/point_to_mesh.h"

namespace trephine::boolean {

ZoneClearance clearance_of(const BurrHole& hole, std::optional<Vec3> toward_mm, const surface::TriMesh& zone) {
  constexpr double step_mm = 0.25;
  const surface::PointToMesh surface(zone);
  const double radius_mm = 0.5 * hole.request.diameter_mm;
  // The cutter goes to where the bone ends over the whole of its cross-section.
  const double cut_mm = std::max(hole.bone_thickness_mm, hole.cutter.depth_mm);
  double end_mm = cut_mm;
  if (toward_mm) end_mm = std::max(end_mm, dot(*toward_mm - hole.position_mm, hole.direction));
  constexpr double longest_mm = 500;
  if (!(end_mm <= longest_mm))
    throw Error(ExitCode::bad_input, "", "toward", "lies more than 500 mm from the hole: that is in no head");
  ZoneClearance least{1e9, hole.position_mm};
  const int steps = static_cast<int>(end_mm / step_mm) + 1;
  for (int n = 0; n <= steps; ++n) {
    const double along_mm = std::min(n * step_mm, end_mm);
    const Vec3 at = hole.position_mm + hole.direction * along_mm;
    const double mm = surface.signed_distance_mm(at) - (along_mm <= cut_mm ? radius_mm : 0);
    if (mm < least.least_mm) least = {mm, at};
  }
  return least;
}

}  // namespace trephine::boolean
