// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <optional>
#include <string>

#include "base/report.h"
#include "boolean/cutter.h"
#include "surface/trimesh.h"

namespace trephine {

/// A burr hole as it is asked for.
struct BurrHoleRequest {
  enum class At { position, kocher } at = At::kocher;
  enum class Side { right, left } side = Side::right;
  std::string name;               ///< "burr_hole_1" where empty
  Vec3 position_mm;               ///< At::position: on or above the skull
  double diameter_mm = 14;        ///< 1 to 60
  double along_mm = 110;          ///< Kocher's point: from the nasion over the midline of the skin ...
  double lateral_mm = 27.5;       ///< ... and to the side over the skin
  std::optional<Vec3> direction;  ///< unit, into the head; else towards `toward_mm`, else perpendicular to the skull
  std::optional<Vec3> toward_mm;
};

struct BurrHole {
  BurrHoleRequest request;
  Vec3 skin_mm;                  ///< where the axis enters the skin
  Vec3 position_mm;              ///< where the axis meets the skull's outer surface
  Vec3 direction;                ///< unit, into the head
  double bone_thickness_mm = 0;  ///< along the axis, to where the bone first ends
  Cutter cutter;  ///< a cylinder from outside the skin to just through the inner table, by at least clearance
};

/// Places one. Landmarks (world mm) by name; Kocher's point needs `nasion`, and for the midsagittal plane `inion` or
/// `vertex`, and `tragus_left` and `tragus_right` where they are there (else the plane holds nasion, inion and the
/// scan's superior axis). `skin` and `skull` are their undecimated surfaces, closed, outwards; skin may be null only
/// for At::position, or the arc is measured on the skull (said in the report). Source of Kocher's point: 11 cm from the
/// nasion along the midline, 2.5 to 3 cm lateral [Rizzi, chapter 7]. Both arcs run along the outermost contour in their
/// plane (outer_curve.h).
///
/// Perpendicular to the skull: the normal of the plane that fits its outer surface within the hole's radius (3 mm at
/// least) best, places that stand out or are sunk in left aside. The hole ends where the bone first ends, over its
/// whole cross-section, plus 1 mm; gaps of up to 3 mm along the axis (diploe cells) do not end it, a wider one does
/// (the frontal sinus: such a hole stops within it). It begins 2 mm outside the skin, or 20 mm above the skull where
/// there is none.
///
/// The report: bone_thickness_mm, soft_tissue_mm, arc lengths, the angle between axis and the skull's normal, the share
/// of the hole that lies on bone, what the midline and the arcs were taken from. Throws 78 for a request out of range
/// or landmarks that contradict each other; 80 where a landmark is missing, naming it and how to give it, where the arc
/// runs over the scan's edge, where the axis misses the skull (or less than three quarters of the hole lie on it),
/// where the inner table within the hole lies more than 9 mm deeper than on the axis, or the hole would leave the
/// volume (cut_faces.h). The field is burr_holes.<name>. Deterministic.
BurrHole place_burr_hole(const BurrHoleRequest& request, const std::map<std::string, Vec3>& landmarks_mm,
                         const TriMesh* skin, const TriMesh& skull, Report& report);

}  // namespace trephine
