// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <optional>
#include <string>

#include "base/result.h"
#include "boolean/cutter.h"
#include "surface/trimesh.h"

namespace trephine::boolean {

/// A burr hole as it is requested.
struct BurrHoleRequest {
  enum class At { position, kocher } at = At::kocher;
  enum class Side { right, left } side = Side::right;
  std::string name;               ///< "burr_hole_1" where empty
  Vec3 position_mm;               ///< At::position: on or above the skull
  double diameter_mm = 14;        ///< from 1 to 60
  double along_mm = 110;          ///< Kocher's point: distance from the nasion over the midline of the skin ...
  double lateral_mm = 27.5;       ///< ... and to the side over the skin
  std::optional<Vec3> direction;  ///< unit, into the head; else towards `toward_mm`, else perpendicular
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

/// How Kocher's point was measured.
struct ArcFigures {
  std::string midline_from, arcs_on;
  double nasion_to_surface_mm = 0, arc_along_mm = 0, arc_lateral_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = ArcFigures;
    v.text(&P::midline_from, "midline_from", "What the midline was taken from.");
    v.text(&P::arcs_on, "arcs_on", "What the arcs were measured over.");
    v.number(&P::nasion_to_surface_mm, "nasion_to_surface_mm", Range{}, "How far the nasion lies from it.");
    v.number(&P::arc_along_mm, "arc_along_mm", Range{}, "From the nasion along the midline.");
    v.number(&P::arc_lateral_mm, "arc_lateral_mm", Range{}, "To the side.");
  }
};
struct BurrHoleResult {
  std::optional<ArcFigures> arcs;  ///< At::kocher
  double bone_thickness_mm = 0;
  std::optional<double> soft_tissue_mm;  ///< where there is a skin
  double axis_to_normal_deg = 0;         ///< between the axis and the skull's normal
  double on_bone_ratio = 0;              ///< share of the hole that lies on bone
  double cutter_depth_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = BurrHoleResult;
    v.all_of(&P::arcs);
    v.number(&P::bone_thickness_mm, "bone_thickness_mm", Range{}, "Bone along the axis.");
    v.number(&P::soft_tissue_mm, "soft_tissue_mm", "From the skin to the bone along the axis.");
    v.number(&P::axis_to_normal_deg, "axis_to_normal_deg", Range{}, "Between the axis and the skull's normal.");
    v.number(&P::on_bone_ratio, "on_bone_ratio", Range{}, "Share of the hole that lies on bone.");
    v.number(&P::cutter_depth_mm, "cutter_depth_mm", Range{}, "How deep the cutter reaches below the bone's surface.");
  }
};

/// Places a burr hole. Landmarks are given by name, in world mm. Kocher's point needs `nasion`; the midsagittal plane
/// needs `inion` or `vertex`, and uses `tragus_left` and `tragus_right` where they are given (otherwise the plane holds
/// nasion, inion and the scan's superior axis). `skin` and `skull` are their undecimated surfaces, closed and oriented
/// outwards. `skin` may be null only for At::position; otherwise the arc is measured on the skull (arcs_on). Kocher's
/// point is 11 cm from the nasion along the midline and 2.5 to 3 cm lateral [Rizzi, chapter 7]. Both arcs run along the
/// outermost contour in their plane (outer_curve.h).
///
/// Perpendicular to the skull means along the normal of the plane that best fits its outer surface within the hole's
/// radius (at least 3 mm), without places that stand out or are sunk in. The hole ends 1 mm behind the place where the
/// bone first ends over the hole's whole cross-section. Gaps of up to 3 mm along the axis (diploe cells) do not end the
/// bone; a wider gap does (the frontal sinus: such a hole stops within it). The hole begins 2 mm outside the skin, or
/// 20 mm above the skull where there is no skin.
///
/// Throws Error 78 for a request out of range or landmarks that contradict each other. Throws Error 80 where a landmark
/// is missing (naming it and how to give it), where the arc runs over the scan's edge, where the axis misses the skull
/// or less than three quarters of the hole lie on it, where the inner table within the hole lies more than 9 mm deeper
/// than on the axis, or where the hole would leave the volume (cut_faces.h). The field is burr_holes.<name>.
/// Deterministic.
Outcome<BurrHole, BurrHoleResult> place_burr_hole(const BurrHoleRequest& request,
                                                  const std::map<std::string, Vec3>& landmarks_mm,
                                                  const surface::TriMesh* skin, const surface::TriMesh& skull);

}  // namespace trephine::boolean
