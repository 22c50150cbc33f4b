// SPDX-License-Identifier: GPL-3.0-or-later
// Lengths over the midline's skin, and what lies below it.
#include <algorithm>
#include <cmath>

#include "head/landmarks_parts.h"
#include "mask/filters.h"

namespace trephine::head {
namespace {

constexpr double no_bone_mm = 40;  ///< how far below the skin bone is looked for

}  // namespace

MidlineArc midline_arc(const craniometry::FieldView& skin, const HeadFrame& head, Vec3 nasion_mm,
                       const Vec3* inion_mm) {
  MidlineArc arc;
  const auto onto_plane = [&](Vec3 p) { return p - head.left * dot(p - head.origin_mm, head.left); };
  arc.centre_mm = onto_plane(inion_mm ? (nasion_mm + *inion_mm) * 0.5 : head.origin_mm);
  const Vec3 front = nasion_mm - arc.centre_mm;
  arc.front = normalized(front - head.left * dot(front, head.left));
  arc.onwards = cross(arc.front, head.left);
  arc.skin = craniometry::outline(skin, {arc.centre_mm, arc.front, arc.onwards, 5, 195});
  const std::vector<Vec3>& p = arc.skin.points_mm;
  arc.nasion_gap_mm = arc.skin.start < p.size() ? norm(p[arc.skin.start] - nasion_mm) : 1e9;
  return arc;
}

double widest_leap_mm(const craniometry::Outline& arc, double length_mm) {
  double widest = 0, walked = 0;
  for (std::size_t i = arc.start + 1; i < arc.points_mm.size() && walked < length_mm; ++i) {
    const double step = norm(arc.points_mm[i] - arc.points_mm[i - 1]);
    widest = std::max(widest, step);
    walked += step;
  }
  return widest;
}

double arc_length_to_mm(const craniometry::Outline& arc, Vec3 point_mm) {
  double best = 1e9, at = 0;
  for (double length = 0; length < 500; length += 1) {
    const auto p = surface::point_along(arc, length);
    if (!p) break;
    if (const double off = norm(*p - point_mm); off < best) best = off, at = length;
  }
  return at;
}

double soft_tissue_mm(const craniometry::FieldView& skull, Vec3 on_skin_mm, Vec3 inwards) {
  const auto bone = skull.enter(on_skin_mm - inwards, inwards, no_bone_mm, 0.4);
  return bone ? norm(*bone - on_skin_mm) : no_bone_mm;
}

double scalp_ratio(double soft_mm) { return std::min(mask::ramp(soft_mm, 0.3, 1.5), mask::ramp(soft_mm, 22, 13)); }

bool runs_over_edge(const craniometry::FieldView& skin, const craniometry::Outline& curve, Vec3 end) {
  if (curve.start >= curve.points_mm.size()) return true;
  const Vec3 start = curve.points_mm[curve.start];
  const double reach = norm(end - start);
  for (std::size_t i = curve.start; i < curve.points_mm.size(); ++i) {
    if (norm(curve.points_mm[i] - start) > reach + 0.5) break;
    if (skin.depth_in_scan_mm(curve.points_mm[i]) < 0.3) return true;
  }
  return false;
}

}  // namespace trephine::head
