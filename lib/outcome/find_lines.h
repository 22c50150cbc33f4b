// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "lesson/outcome_record.h"
#include "outcome/case_chest.h"

namespace trephine::outcome {

/// Finds dense, thin and long things in a chest that are no bone of the case, the surest first, each followed from its
/// tip to the skin and as long as it lies in the patient. What the case's own CT shows just as dense at the same places
/// was there before. `map` leads from the case to the scan. error_mm, clavicle_moved_mm and the verdict are the
/// caller's; what of a line itself is not sure is in `doubts`. Cancelled.
std::vector<lesson::OutcomeLine> find_lines(const CaseChest& chest, const ScanView& scan, const itk::LinearMap& map,
                                            const Progress& progress = {});

}  // namespace trephine::outcome
