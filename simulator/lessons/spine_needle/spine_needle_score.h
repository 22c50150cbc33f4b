// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/score.h"
#include "lessons/spine/pedicle_errors.h"
#include "lessons/spine_needle/spine_needle_rubric.h"

namespace trephine::lessons {

/// Scores a needle in a pedicle. A pure function: the same facts, case, volume and rubric give the same rows. A pedicle
/// whose axis is doubtful is not judged.
LessonScore score_spine_needle(const SpineNeedleFacts& facts, const cases::CaseManifest& manifest,
                               const voxel::HapticVolume& before, const SpineNeedleRubric& rubric);

}  // namespace trephine::lessons
