// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "lesson/outcome_record.h"
#include "outcome/case_head.h"

namespace trephine::outcome {

/// Finds dense, thin and long things within the case's brain that lead to its bone, the surest first. Each is followed
/// between the voxels by the middle of what is denser than tissue across it; its tip is where that, summed across,
/// drops to half, which a wider kernel or thicker slices do not move, and what a rounded end of a catheter reaches
/// beyond. What is short, thick or bent like no catheter is left out: calcified plexus, clips, the skull's edge. `map`
/// leads from the case to the scan. error_mm and the verdict are the caller's. Cancelled.
std::vector<lesson::OutcomeCourse> find_courses(const CaseHead& head, const ScanView& scan, const itk::LinearMap& map,
                                                const Progress& progress = {});

}  // namespace trephine::outcome
