// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/lesson.h"
#include "lessons/score.h"

namespace trephine::lessons {

/// "Time to complete procedure", with the time paused where there was a pause. Where the lesson was not completed,
/// `unfinished` says why, and the score is 1; else it is empty.
ScoreRow time_row(const LessonFacts& facts, const lesson::TimeRubric& rubric, const texts::Phrase& unfinished);

}  // namespace trephine::lessons
