// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "lesson/outcome_record.h"
#include "outcome/case_head.h"

namespace trephine::outcome {

struct MadeGaps {
  std::vector<lesson::OutcomeHole> holes;
  std::vector<lesson::OutcomeOpening> openings;  ///< of 5 cm2 and more
};

/// Finds where the case has bone and the scan has none, the largest first: along rays from the brain the mean HU over
/// the case's bone, as a share of what is usual beside it. What lies within the width of a course does not count, for a
/// catheter fills part of its hole. `bare_bone`: a print has no scalp, by which else what no slice covers is told from
/// air. `map` leads from the case to the scan. error_mm is the caller's. Cancelled.
MadeGaps find_made_holes(const CaseHead& head, const ScanView& scan, const itk::LinearMap& map,
                         const std::vector<lesson::OutcomeCourse>& courses, bool bare_bone,
                         const Progress& progress = {});

}  // namespace trephine::outcome
