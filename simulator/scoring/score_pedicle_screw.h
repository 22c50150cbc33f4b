// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lesson/pedicle_screw_rubric.h"
#include "scoring/score_spine_needle.h"

namespace trephine {

/// Whether the tool is a screw, not the finder.
bool is_screw(const NeedlePass& pass);

/// The five errors of a screw: each is a row with 5 (none) or 1 (an error); the last row says whether the screw is
/// acceptable. A pure function: the same facts, case, volume and rubric give the same rows.
LessonScore score_pedicle_screw(const SpineNeedleFacts& facts, const CaseManifest& manifest, const HapticVolume& before,
                                const PedicleScrewRubric& rubric);

}  // namespace trephine
