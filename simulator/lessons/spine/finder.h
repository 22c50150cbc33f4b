// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "haptics/tool_belt.h"
#include "lessons/lesson_type.h"
#include "lessons/spine/five_errors_score.h"

namespace trephine::lessons {

/// The pedicle finder of the open exercise [Rizzi, chapter 8.2.2]: 4 mm wide, 80 mm long.
haptics::BeltToolParams finder_tool();
/// What all lessons by the five errors (five_errors_score.h) have: what they need, their moves, facts, field and
/// pictures, the columns of their logs, and what is said of them in the end.
void set_five_errors_lesson(LessonType& type, JudgedTool judged);
/// The guide's step of the finder, and its words.
LessonGuide finder_guide();
std::vector<LessonText> finder_words();

}  // namespace trephine::lessons
