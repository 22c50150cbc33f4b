// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/score.h"
#include "lessons/ventriculostomy/critical_zones.h"
#include "lessons/ventriculostomy/ventriculostomy_rubric.h"
#include "lessons/ventriculostomy/ventriculostomy_watch.h"

namespace trephine::lessons {

struct LessonText;

/// Scores a ventriculostomy by Table XIII of the dissertation. A pure function: the same facts, case with its zones,
/// volume as the lesson began, and rubric give the same rows. What a doubtful suture or a hole that was there
/// beforehand leaves open is not judged.
LessonScore score_ventriculostomy(const VentriculostomyFacts& facts, const cases::CaseManifest& manifest,
                                  const voxel::HapticVolume& before, const VentriculostomyRubric& rubric,
                                  const CriticalZones& zones = {});

/// What the rows say, for LessonType::texts.
std::vector<LessonText> ventriculostomy_words();

}  // namespace trephine::lessons
