// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "lessons/lesson_type.h"
#include "lessons/lesson_words.h"
#include "texts/language.h"

namespace trephine::lessons {

/// What a participant reads before a lesson: what is asked for and why, and each step with its reason and its sign.
struct LessonBriefing {
  LessonTask task;  ///< without a name where the case holds none
  std::vector<LessonGuide> steps;
};
/// Of the lesson in that case; `task` empty: the usual. Throws Error 65 as LessonType::require and task_of do.
LessonBriefing briefing_of(const LessonType& type, const cases::LoadedCase& loaded, const std::string& task);
std::string briefing_text(const LessonType& type, const LessonBriefing& briefing, texts::Language language);
/// The steps as a list of a report's page.
std::string steps_html(const std::vector<LessonGuide>& steps, texts::Language language);

const std::string& aim_of(const LessonTask& task, texts::Language language);
const std::string& indication_of(const LessonTask& task, texts::Language language);
/// The steps in their order: the lesson's own, or a step for each tool, and the end.
std::vector<LessonGuide> guide_of(const LessonType& type, const LessonFacts& facts);
/// Whether a step is for that tool.
bool is_for_tool(const LessonGuide& step, const std::string& tool);

}  // namespace trephine::lessons
