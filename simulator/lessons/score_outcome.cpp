// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/score_outcome.h"

#include "base/error.h"
#include "cases/load_hashed.h"
#include "lesson/approval.h"
#include "lesson/outcome_record.h"
#include "lessons/lesson_type.h"

namespace trephine::lessons {

ScoredLesson score_outcome(const std::filesystem::path& file, const std::filesystem::path& case_folder,
                           const lesson::CompiledRubric& rubric, const std::string& participant,
                           const std::string& task) {
  lesson::validate_token(participant, "--participant");
  std::string sha256;
  const lesson::OutcomeRecord record = lesson::read_outcome(file, &sha256);
  const LessonType& type = lesson_type(rubric.module);
  if (!type.facts_of_outcome)
    throw Error(ExitCode::usage, "", "--rubric",
                "is of " + rubric.module +
                    ", of which a CT after the procedure is not judged; give that of a "
                    "ventriculostomy, a pedicle screw, a needle in the spine or a subclavian line");
  const cases::HashedCase read = cases::load_hashed_case(case_folder);
  if (record.case_sha256 != read.sha256)
    throw Error(ExitCode::bad_input, file.string(), "case_sha256",
                "it was measured in another case.json (case " + record.case_token +
                    "); measure it again in this case by trephine outcome");
  with_file(case_folder.string(), [&] { type.require(read.loaded.manifest); });
  ScoredLesson s;
  const std::string asked = task.empty() ? "" : task_of(type, read.loaded.manifest, task).name;
  const std::shared_ptr<LessonFacts> facts = type.facts_of_outcome(record, read.loaded, asked);
  facts->task = asked;
  s.facts = facts;
  s.score = type.score(*s.facts, read.loaded, read.loaded.haptic, rubric.rubric);
  for (ScoreRow& row : s.score.rows) row.decided_s.reset();  // a CT has no moments
  for (CriticalError& e : s.score.critical) e.at_s.reset();
  s.head.case_token = record.case_token;
  s.head.module = rubric.module;
  s.head.participant = participant;
  s.head.recording_sha256 = s.head.motion_sha256 = sha256;
  s.head.rubric_sha256 = rubric.sha256;
  s.head.case_sha256 = read.sha256;
  s.head.measured = true;
  return s;
}

}  // namespace trephine::lessons
