// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>

#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "commands/commands.h"
#include "modules/lesson_run.h"
#include "scoring/attempts.h"
#include "scoring/report_page.h"

namespace trephine {
namespace {

CompiledRubric rubric_of(const std::string& file) {
  return with_file(file, [&] {
    const std::vector<char> bytes = read_file(file, 1 << 20);
    return read_rubric({bytes.data(), bytes.size()});
  });
}

ExitCode run_score(const ParsedCommand& parsed) {
  const std::string file = parsed.text("recording");
  const CompiledRubric rubric = rubric_of(parsed.text("rubric"));
  const Recording recording = read_recording(file);
  FeltCase felt = felt_again(parsed.path("case"), file, recording.header);
  const HapticVolume before = felt.loaded.haptic;
  const VentriculostomyFacts facts = facts_of_recording(felt, file, recording);
  const LessonScore score = score_ventriculostomy(facts, felt.loaded.manifest, before, rubric.rubric);
  const RecordingHeader& h = recording.header;
  const ReportHead head{h.case_token, h.lesson, h.participant, sha256_of_file(file), rubric.sha256, h.haptic_sha256};
  if (parsed.has("json")) write_file(parsed.path("json"), score_json(head, facts, score));
  if (parsed.has("page"))
    write_file(parsed.path("page"),
               report_page(head, facts, score, recording, load_case(parsed.path("case"), LoadParts{true})));
  if (parsed.has("log")) log_attempt(parsed.path("log"), head, facts, score);
  std::cout << score_text(facts, score);
  return ExitCode::ok;
}

}  // namespace

Command score_command() {
  using Kind = Argument::Kind;
  Command c;
  c.name = "score";
  c.summary = "judges a recorded lesson by a rubric";
  c.description =
      "Follows the recording through the case, and scores what happened: by Table XIII of the dissertation for a "
      "ventriculostomy. Each row has its measured figure, the limits that were applied, whether these are the "
      "dissertation's or ours, and the moment at which it was decided. What the case leaves doubtful is not judged. "
      "The same recording, case and rubric give the same bytes, so a session can be judged again years later, by "
      "another rubric as well. docs/lessons.md says what each row measures.";
  Argument recording = argument("recording", Kind::in_file, "The recording of a lesson.");
  recording.positional = recording.required = true;
  Argument folder = argument("case", Kind::in_folder, "Folder of the case in which it was done.");
  Argument rubric = argument("rubric", Kind::in_file, "The rubric, as `trephine rubric` compiled it (.json).");
  folder.required = rubric.required = true;
  c.arguments = {recording,
                 folder,
                 rubric,
                 argument("json", Kind::out_file, "Write the report to this file."),
                 argument("page", Kind::out_file, "Write the report as a page (.html) that a person reads."),
                 argument("log", Kind::out_file, "Add the attempt to this log (.csv), for statistics.")};
  c.examples = {
      "trephine-sim score one.lesson --case library/sample --rubric ventriculostomy.rubric.json --json one.json "
      "--page one.html --log attempts.csv"};
  c.run = run_score;
  return c;
}

}  // namespace trephine
