// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/score.h"
#include "lessons/spine/pedicle_errors.h"

namespace trephine::lessons {

/// Notes the critical errors that happened, in any pass and at any time, whatever came after: anterior_cortex_mm,
/// canal, medial_breach_mm, other_breach_mm, beside_spine_mm, great_vessel, wrong_side and wrong_level. A pass that is
/// farther than `farthest_mm` from every pedicle's entry is at none.
void note_spine_errors(const SpineNeedleFacts& facts, const cases::CaseManifest& manifest,
                       const voxel::HapticVolume& before, double farthest_mm, CriticalErrors& errors);

/// What may be asked for: a pedicle of the case, those that are sure first.
std::vector<std::string> pedicle_tasks(const cases::CaseManifest& manifest);
/// LessonTask::doubt of such a task.
std::string pedicle_doubt(const cases::CaseManifest& manifest, const std::string& task);
/// A pedicle as a row or an error names it: pedicle_2_left is "pedicle 2 left"; any other name stays as it is.
texts::Phrase pedicle_phrase(const std::string& name);
/// "the left pedicle 2, counted from the lowest vertebra that the scan shows".
std::string pedicle_in_words(const std::string& task, bool german = false);

}  // namespace trephine::lessons
