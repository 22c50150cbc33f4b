// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "cases/load_case.h"
#include "cases/pedicles.h"
#include "outcome/bone_points.h"

namespace trephine::outcome {

/// Whether the case is one of a spine: bone to be felt, and pedicles.
bool is_spine(const cases::LoadedCase& loaded);

/// What of a case a procedure on a spine is measured by. It refers to the case, which must outlive it.
struct CaseSpine {
  /// A vertebra by its pedicles, from the lowest.
  struct Level {
    int number = 0;  ///< as its pedicles have it
    Vec3 middle_mm;
  };
  const cases::LoadedCase& loaded;
  voxel::HapticDecoder decoder;
  int bone = 0;
  std::vector<cases::CasePedicle> pedicles;
  std::vector<Level> levels;
  Vec3 cranial{0, 0, 1};  ///< along the vertebrae
  double pitch_mm = 35;   ///< from one to the next

  explicit CaseSpine(const cases::LoadedCase& loaded);
  /// The level of which a place is; -1 where it is beyond the lowest and highest.
  int level_of(Vec3 p) const;
  /// Of a pedicle.
  int level_of(const cases::CasePedicle& pedicle) const;
  bool is_bone(Vec3 p) const { return decoder.trilinear(bone, p) >= 0.5; }
};

}  // namespace trephine::outcome
