// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/score.h"
#include "lessons/spine/pedicle_errors.h"

namespace trephine::lessons {

/// Sentences that say what to do otherwise at a pedicle; medial and lateral are of the pedicle's side.

/// Of the rows `entry` and `target` that lost points. Where the direction was right and the entry alone was missed, the
/// target's sentence says so.
std::vector<Advice> pedicle_advice(const LessonScore& score, const NeedleErrors& errors);
/// Of the rows `entry`, `axial` and `sagittal` of a screw or a finder: where its line passed the coronal plane of the
/// entry, and by how many degrees it leaned more to the patient's left and to the head than the ideal axis.
std::vector<Advice> five_errors_advice(const LessonScore& score, const NeedleErrors& errors, Vec3 entry_off_mm,
                                       double left_deg, double up_deg, bool of_screw);
/// The tip lies that far beyond the target; negative: before it.
Advice depth_advice(const std::string& row, double beyond_target_mm);
Advice breach_advice(const PedicleBreach& breach);

}  // namespace trephine::lessons
