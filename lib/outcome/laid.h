// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "outcome/bone_fit.h"
#include "outcome/measure_outcome.h"

namespace trephine::outcome {

/// How the case lies in the scan, and how well that is known at a place of the case.
struct Laid {
  itk::LinearMap map;
  lesson::OutcomeRegistration registration;
  std::function<double(Vec3)> error_mm;
};

/// One rigid body, a head or a chest, laid by its bone and held against its doubts. Throws Error 80 with the field
/// `registration` where the scan shows another `body`, a mirrored one, or too little of it; Cancelled.
Laid laid_by_bone(const std::vector<BonePoint>& points, const ScanView& scan, const char* body, const char* remedy,
                  const OutcomeParams& params, const Progress& progress = {});

}  // namespace trephine::outcome
