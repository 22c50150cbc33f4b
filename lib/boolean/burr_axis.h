// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The axis of a burr hole, perpendicular to the skull, and what it meets on its way. Lengths along it are mm from a
// given point.
#include <vector>

#include "boolean/cut_faces.h"
#include "boolean/cutter.h"
#include "surface/trimesh.h"

namespace trephine::boolean::detail {

/// Unit vector into the head, opposite to the normal of the plane that best fits the skull's outer surface where the
/// axis through `through_mm` meets it, within the radius (at least 3 mm). Places that lie off the plane by more than
/// 0.5 mm and by more than three times the median are left out. Found by iteration from `inwards`. Throws Error 80
/// where the skull is not met.
Vec3 perpendicular_to_skull(const surface::TriMesh& skull, Vec3 through_mm, Vec3 inwards, double radius_mm);

/// What a hole of that radius meets.
struct HoleSection {
  double begin_mm = 0;                          ///< where the cutter begins: outside the skin over the whole hole
  double skin_enter_mm = 0;                     ///< on the axis; bone_enter_mm where there is no skin
  double bone_enter_mm = 0, bone_leave_mm = 0;  ///< on the axis
  double bone_begin_mm = 0;                     ///< the first bone over the whole hole
  double end_mm = 0;                            ///< where the cutter ends: behind the first bone over the whole hole
  double on_bone_ratio = 1;                     ///< share of the hole that meets bone there
};

/// `skin` may be null. Throws Error 80 where the axis meets no skull within 40 mm of the point, where less than three
/// quarters of the hole lie on the skull, or where its inner surface within the hole lies more than 9 mm deeper than on
/// the axis.
HoleSection hole_section(const surface::TriMesh& skull, const surface::TriMesh* skin, Vec3 through_mm, Vec3 direction,
                         double radius_mm);

/// Throws Error 80 where the cutter, from `from_mm` on along its axis, leaves the scanned volume.
void check_within_scan(const Cutter& cutter, double from_mm, const std::vector<CutFace>& faces);

}  // namespace trephine::boolean::detail
