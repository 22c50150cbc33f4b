// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>

#include "base/vec3.h"
#include "cases/case.h"

namespace trephine::lessons {

/// What of a head a lesson is measured by, from the case's landmarks. LPS, mm.
struct HeadFrame {
  Vec3 left{1, 0, 0};             ///< unit normal of the midsagittal plane
  double plane_mm = 0;            ///< of its points along `left`
  double midline_confidence = 0;  ///< the least of the three landmarks that span it
  Vec3 centre_mm;                 ///< of the circle through them: about the middle of the vault
  Vec3 nasion_mm;
  std::optional<Vec3> bregma_mm;  ///< where the coronal suture crosses the midline
  double suture_confidence = 0;   ///< the least of bregma and nasion
  Vec3 forwards{0, -1, 0};        ///< unit: along the vault at the bregma, towards the nasion
  Vec3 upwards{0, 0, 1};          ///< unit: out of the vault there

  double left_of_midline_mm(Vec3 p) const { return dot(left, p) - plane_mm; }
  /// Along the vault, positive in front of the suture; as burr holes are checked (before_suture_mm of their figures).
  double before_suture_mm(Vec3 p) const { return bregma_mm ? dot(p - *bregma_mm, forwards) : 0; }
};

/// The frame, from those three of nasion, bregma, vertex and inion that span the largest triangle, counted by the least
/// of their confidences. Throws Error 65
/// where the case has no nasion, or fewer than three of them, or these lie on a line: such a case holds no such lesson.
HeadFrame head_frame_of(const cases::CaseManifest& manifest);

const cases::CaseLandmark* find_landmark(const cases::CaseManifest& manifest, const std::string& name);
/// The foramen of Monro of that side, which the lesson aims at: a target or landmark; null where there is none.
std::optional<Vec3> foramen_of(const cases::CaseManifest& manifest, bool left, double* confidence = nullptr);

}  // namespace trephine::lessons
