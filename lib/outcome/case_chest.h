// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <vector>

#include "cases/load_case.h"
#include "outcome/bone_points.h"

namespace trephine::outcome {

/// Whether the case is one of a chest: skin and clavicles to be felt.
bool is_chest(const cases::LoadedCase& loaded);

/// What of a case a central line is measured by. It refers to the case, which must outlive it.
struct CaseChest {
  const cases::LoadedCase& loaded;
  voxel::HapticDecoder decoder;
  int skin = 0, clavicle = 0, other_bone = 0, vein = 0, artery = 0, lung = 0, pleura = 0;  ///< 0: the case has none
  std::vector<BonePoint> thorax;                    ///< of its surface: other bone between the clavicles' middles
  std::array<std::vector<BonePoint>, 2> clavicles;  ///< of theirs, by side: right, left
  std::array<Vec3, 2> clavicle_mm;                  ///< their middles
  Vec3 left{1, 0, 0};

  explicit CaseChest(const cases::LoadedCase& loaded);
  bool is_left(Vec3 p) const { return dot(p - (clavicle_mm[0] + clavicle_mm[1]) * 0.5, left) > 0; }
  bool is_bone(Vec3 p) const { return holds(clavicle, p) || holds(other_bone, p); }
  bool is_patient(Vec3 p) const;  ///< within the skin; above and below the case as at its ends
  bool holds(int shape, Vec3 p) const { return shape != 0 && decoder.trilinear(shape, p) >= 0.5; }
};

}  // namespace trephine::outcome
