// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "cases/load_case.h"
#include "mask/coarse.h"
#include "outcome/bone_points.h"

namespace trephine::outcome {

/// What of a case a head's procedure is measured by. It refers to the case, which must outlive it.
struct CaseHead {
  const cases::LoadedCase& loaded;
  voxel::HapticDecoder decoder;
  int bone = 0;
  mask::BitMask inside;  ///< the brain with its sulci closed, off the bone, on cells
  Vec3 middle_mm;        ///< of the brain
  Vec3 left{1, 0, 0};    ///< unit normal of the midsagittal plane
  double plane_mm = 0;

  /// Throws Error 65 where the case has no bone or brain to be felt.
  explicit CaseHead(const cases::LoadedCase& loaded, const Progress& progress = {});
  /// Whether the case's own CT shows bone there, and not an air cell within it; true without a CT.
  bool shows_bone(Vec3 p) const;
  double left_mm(Vec3 p) const { return dot(left, p) - plane_mm; }
  std::string side_of(Vec3 p) const { return left_mm(p) > 5 ? "left" : left_mm(p) < -5 ? "right" : "middle"; }
  bool is_inside(Vec3 p) const;
};

/// Where a ray from within the head passes the case's bone: the first stretch of at least `least_mm`.
struct Passage {
  double inner_mm = 0, outer_mm = 0;  ///< along the ray
};
std::optional<Passage> passage_of(const CaseHead& head, Vec3 from_mm, Vec3 way, double reach_mm, double least_mm = 1.5);

}  // namespace trephine::outcome
