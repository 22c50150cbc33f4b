// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/pedicle_screw/pedicle_screw_rubric.h"
#include "lessons/score.h"
#include "lessons/spine/pedicle_errors.h"

namespace trephine::lessons {

/// Whether the tool is a screw, not the finder.
bool is_screw(const NeedlePass& pass);

/// The five errors of a screw: each is a row with 5 (none) or 1 (an error); the next row says whether the screw is
/// acceptable. Beside them, where the rubric has their limits: the screw's size, X-rays, passes, time. A pure function:
/// the same facts, case, volume and rubric give the same rows.
LessonScore score_pedicle_screw(const SpineNeedleFacts& facts, const cases::CaseManifest& manifest,
                                const voxel::HapticVolume& before, const PedicleScrewRubric& rubric);

}  // namespace trephine::lessons
