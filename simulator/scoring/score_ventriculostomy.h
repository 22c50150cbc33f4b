// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lesson/ventriculostomy_rubric.h"
#include "modules/ventriculostomy.h"
#include "scoring/critical_zones.h"
#include "scoring/score.h"

namespace trephine {

/// Scores a ventriculostomy by Table XIII of the dissertation. A pure function: the same facts, case with its zones,
/// volume as the lesson began, and rubric give the same rows. What a doubtful suture or a hole that was there
/// beforehand leaves open is not judged.
LessonScore score_ventriculostomy(const VentriculostomyFacts& facts, const CaseManifest& manifest,
                                  const HapticVolume& before, const VentriculostomyRubric& rubric,
                                  const CriticalZones& zones = {});

}  // namespace trephine
