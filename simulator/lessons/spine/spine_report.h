// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/lesson_type.h"

namespace trephine::lessons {

/// What the lessons in a spine share: the steps of their scripts, the facts (SpineNeedleFacts) as JSON, what a window
/// says and shows of a SpineNeedle, and the page's pictures: what was seen under fluoroscopy, and the last tool beside
/// the ideal axis over the CT.
std::vector<StepChoice> spine_steps();
/// What the rows of their scores say, for LessonType::texts.
std::vector<LessonText> spine_words();
nlohmann::ordered_json spine_facts_json(const LessonFacts& facts);
/// All pedicles of the case lie in it.
LessonField spine_field(const LessonFacts& facts, const cases::CaseManifest& manifest);
std::vector<LessonStatus> spine_status(const LessonFacts& facts);
LessonXray spine_xray(const Lesson& lesson, const cases::CaseManifest& manifest);
std::vector<LessonShot> spine_shots(const LessonFacts& facts, const cases::CaseManifest& manifest);
std::string spine_pictures(const LessonFacts& facts, const cases::LoadedCase& loaded, texts::Language language);

}  // namespace trephine::lessons
