// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "cases/case.h"
#include "lesson/outcome_record.h"
#include "voxel/decode.h"

namespace trephine::lessons {

constexpr double way_step_mm = 0.25;  ///< between points of a pass's path, as in a lesson

/// The points of an instrument that a scan shows, from where it enters to its tip. `course` begins at the tip.
std::vector<Vec3> way_inwards(const std::vector<lesson::OutcomePlace>& course, Vec3 tip_mm);
/// The felt shape that holds the point; 0: none.
int shape_about(const voxel::HapticDecoder& decoder, const cases::CaseHaptic& haptic, Vec3 place_mm);

}  // namespace trephine::lessons
