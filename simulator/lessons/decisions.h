// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "lesson/rubric.h"
#include "lessons/lesson_type.h"
#include "lessons/score.h"

namespace trephine::lessons {

/// The questions of a rubric as this participant is asked them in this case. The answers' order and the wrong ones
/// among tokens and tasks follow from case, participant and question alone, so that whoever knows these finds the same.
/// A question that the case cannot offer, as one for the task where there is only one, is left out. A
/// recording holds what this gives, and is refused where it gives something else: a change raises recording_version.
std::vector<OfferedQuestion> questions_for(const lesson::LessonRubric& rubric, const LessonType& type,
                                           const cases::CaseManifest& manifest, const std::string& task,
                                           const std::string& participant);
/// As a recording's header has them.
std::vector<haptics::AskedQuestion> as_asked(const std::vector<OfferedQuestion>& questions);

/// A question as a window or a page shows it.
struct QuestionText {
  LessonText question, why;
  std::vector<LessonText> choices;
};
/// Of one that the rubric has; empty texts where it has none of that name, or no such choice.
QuestionText text_of(const lesson::LessonRubric& rubric, const haptics::AskedQuestion& asked);
const lesson::Question* question_of(const lesson::LessonRubric& rubric, const std::string& name);

/// Judges what was answered, into the score: `decisions`, and the row of that name beside the others. Of the rubric's
/// questions those count that the recording says were asked; one that follows a critical error where that happened. A
/// time-out that was left out, so that the patient was cut before it was done, scores 1, and the lesson is not
/// completed; so it is where patient or task were answered wrongly. Nothing is added where nothing was asked. Where the
/// recording is not `of_rubric` the row is not judged.
void judge_decisions(LessonScore& score, const LessonFacts& facts, const std::vector<haptics::AskedQuestion>& asked,
                     const lesson::LessonRubric& rubric, const std::string& case_token, bool of_rubric);

}  // namespace trephine::lessons
