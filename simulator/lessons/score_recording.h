// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <memory>

#include "haptics/recording.h"
#include "lesson/rubric.h"
#include "lessons/lesson_run.h"
#include "lessons/score_report.h"

namespace trephine::lessons {

/// A recorded lesson with its score.
struct ScoredLesson {
  haptics::Recording recording;
  std::shared_ptr<const LessonFacts> facts;
  LessonScore score;
  ReportHead head;
};

/// Throws Error 65, 66; as read_rubric does, naming the file.
lesson::CompiledRubric read_rubric_file(const std::filesystem::path& file);

/// Reads and scores the recording in its case, and looks whether it is signed by the owner of `public_key` where one is
/// given. Throws as read_recording, felt_again, facts_of_recording, require_no_misfit and the module do; 80 where it
/// does not replay bit for bit and is not trusted; Error 65 where the rubric is of another lesson.
ScoredLesson score_recording(const std::filesystem::path& recording, const std::filesystem::path& case_folder,
                             const lesson::CompiledRubric& rubric, Answers answers = Answers::replayed,
                             const std::filesystem::path& public_key = {});

/// Writes the parts of the report whose paths are not empty: JSON, a page, a line of the log.
struct ReportFiles {
  std::filesystem::path json, page, log;
};
/// Returns whose attempt in the log has the same motion, as "r-01, attempt 2"; empty where none has.
std::string write_report(const ScoredLesson& lesson, const std::filesystem::path& case_folder,
                         const ReportFiles& files);

}  // namespace trephine::lessons
