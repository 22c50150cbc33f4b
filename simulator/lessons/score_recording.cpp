// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/score_recording.h"

#include <algorithm>

#include "base/error.h"
#include "base/refusal.h"
#include "base/write_file.h"
#include "lesson/approval.h"
#include "lessons/attempts.h"
#include "lessons/decisions.h"
#include "lessons/motion.h"
#include "lessons/report_page.h"
#include "lessons/rubric_types.h"
#include "lessons/signature.h"

namespace trephine::lessons {

lesson::CompiledRubric read_rubric_file(const std::filesystem::path& file) {
  return with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, 1 << 20);
    return lesson::read_rubric({bytes.data(), bytes.size()}, rubric_types());
  });
}

namespace {

// Of the rubric that was announced they follow; whoever struck one from the recording would not be asked.
void require_same_questions(const haptics::RecordingHeader& h, const LessonFacts& facts, const LessonType& type,
                            const cases::CaseManifest& manifest, const lesson::CompiledRubric& rubric,
                            const std::filesystem::path& file) {
  if (h.asked.empty() ? facts.answers.empty() : h.rubric_sha256 != rubric.sha256) return;
  const std::vector<OfferedQuestion> all = questions_for(*rubric.common, type, manifest, h.task, h.participant);
  const bool same =
      std::equal(all.begin(), all.end(), h.asked.begin(), h.asked.end(),
                 [](const auto& a, const auto& b) { return a.question == b.question && a.choices == b.choices; });
  if (same) return;
  throw refusal("lesson.asked", "are not the questions of the rubric that the recording names",
                {"take the recording as it was made, or do the `lesson` again"})
      .in_file(file.string());
}

}  // namespace

ScoredLesson score_recording(const std::filesystem::path& file, const std::filesystem::path& case_folder,
                             const lesson::CompiledRubric& rubric, Answers answers,
                             const std::filesystem::path& public_key) {
  ScoredLesson s;
  s.recording = haptics::read_recording(file);
  const haptics::RecordingHeader& h = s.recording.header;
  const Signature signature =
      signature_for(signature_of(s.recording.sha256, file, public_key), h.rubric_sha256, rubric);
  require_no_misfit(signature, file);
  if (answers == Answers::replayed) haptics::require_seal(s.recording, file);
  session::FeltCase felt = session::felt_again(case_folder, file.string(), h);
  with_file(file.string(), [&] {
    try {
      if (!h.lesson.empty()) lesson::validate_token(h.participant, "participant");
    } catch (const Error& e) {
      throw Error(ExitCode::bad_input, "", "participant", e.what());
    }
    if (h.case_token != felt.loaded.manifest.case_token)
      throw Error(ExitCode::bad_input, "", "case", "is not the name of the given case");
  });
  const voxel::HapticVolume before = felt.loaded.haptic;
  s.facts = facts_of_recording(felt, file.string(), s.recording, answers);
  if (rubric.module != h.lesson)
    throw Error(ExitCode::bad_input, file.string(), "lesson", h.lesson + ", but the rubric is of " + rubric.module);
  const LessonType& type = lesson_type(h.lesson);
  s.score = type.score(*s.facts, felt.loaded, before, rubric.rubric);
  doubt_places(s.score, h.place_error_mm);
  require_same_questions(h, *s.facts, type, felt.loaded.manifest, rubric, file);
  // What another rubric asked cannot be held against this one: the answers' order follows from the announced one.
  judge_decisions(s.score, *s.facts, h.asked, *rubric.common, h.case_token, h.rubric_sha256 == rubric.sha256);
  judge_second_hand(s.score, *s.facts, *rubric.common, felt.loaded.manifest.haptic);  // by when it stopped to bleed
  s.head = {h.case_token,
            h.lesson,
            h.participant,
            s.recording.sha256,
            rubric.sha256,
            h.case_sha256,
            motion_digest(s.recording.frames),
            answers == Answers::replayed,
            s.recording.seal,
            signature,
            h.rubric_sha256,
            h.asked.empty() && !rubric.common->questions.empty(),
            motion_figures(s.recording.frames)};
  s.head.place_error_mm = h.place_error_mm;
  return s;
}

std::string write_report(const ScoredLesson& s, const std::filesystem::path& case_folder, const ReportFiles& files) {
  if (!files.json.empty()) write_file(files.json, score_json(s.head, *s.facts, s.score));
  if (!files.page.empty())
    write_file(files.page, report_page(s.head, *s.facts, s.score, s.recording,
                                       cases::load_case(case_folder, cases::LoadParts{true})));
  std::string repeats;
  if (!files.log.empty()) log_attempt(files.log, s.head, *s.facts, s.score, &repeats);
  return repeats;
}

}  // namespace trephine::lessons
