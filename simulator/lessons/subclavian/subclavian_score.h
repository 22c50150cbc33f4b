// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/score.h"
#include "lessons/subclavian/subclavian_rubric.h"
#include "lessons/subclavian/subclavian_watch.h"

namespace trephine::lessons {

struct LessonText;

/// Scores a subclavian line. Pure: the same facts, case, volume as the lesson began, and rubric give the same rows.
/// Where the case shows no artery, or no lung on a side on which the needle was, that row is not judged. Of a CT with a
/// line neither passes nor time are, nor success.
LessonScore score_subclavian(const SubclavianFacts& facts, const cases::CaseManifest& manifest,
                             const voxel::HapticVolume& before, const SubclavianRubric& rubric);

/// Green: blood was drawn from the vein, in which the tip still is, and nothing failed. Red: artery, pleura or lung was
/// entered, there were too many passes, the time is over, or the lesson ended without blood. None: it goes on. Of a CT
/// green is a line that came into the vein and harmed nothing, and none that nothing is judged.
enum class NeedleColour { none, green, red };
NeedleColour needle_colour(const SubclavianFacts& facts, const SubclavianRubric& rubric);

/// What the rows say, for LessonType::texts.
std::vector<LessonText> subclavian_words();

}  // namespace trephine::lessons
