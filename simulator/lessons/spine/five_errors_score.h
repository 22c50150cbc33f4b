// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/score.h"
#include "lessons/spine/five_errors_rubric.h"
#include "lessons/spine/pedicle_errors.h"

namespace trephine::lessons {

/// What is judged: the screw, after the finder; or, of a lesson of the finder alone, the finder.
enum class JudgedTool { screw, finder };
/// Whether the tool is a screw, not the finder.
bool is_screw(const NeedlePass& pass);

/// The five errors of a screw or a finder: each is a row with 5 (none) or 1 (an error); the next row says whether it is
/// acceptable. Beside them, where the rubric has their limits: a screw's size, X-rays, passes, time. A pure function:
/// the same facts, case, volume and rubric give the same rows.
LessonScore score_five_errors(const SpineNeedleFacts& facts, const cases::CaseManifest& manifest,
                              const voxel::HapticVolume& before, const FiveErrorsRubric& rubric, JudgedTool tool);

}  // namespace trephine::lessons
