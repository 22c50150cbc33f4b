// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>

#include "base/error.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "lessons/results.h"
#include "lessons/score_recording.h"

namespace trephine::commands {
namespace {

struct ScoreParams {
  bool trust_recording = false;
  texts::Language language = texts::Language::english;
  template <class V>
  static void describe(V& v) {
    v.flag(&ScoreParams::trust_recording, "trust_recording",
           "Judge the forces, contacts and times that the recording says, without a replay; the report says so.");
    v.choice(&ScoreParams::language, "language", texts::languages(), "Language of the page and of the table.");
  }
};

ExitCode run_score(const cli::ParsedCommand& parsed) {
  const lesson::CompiledRubric rubric = lessons::read_rubric_file(parsed.path("rubric"));
  const bool trust = parsed.params<ScoreParams>().trust_recording;
  lessons::ScoredLesson lesson =
      lessons::score_recording(parsed.path("recording"), parsed.path("case"), rubric,
                               trust ? lessons::Answers::trusted : lessons::Answers::replayed,
                               parsed.has("signed_by") ? parsed.path("signed_by") : "");
  std::vector<std::vector<std::pair<std::string, double>>> experts;
  for (const std::string& file : parsed.all("expert")) {
    const lessons::AttemptResult report = lessons::read_report(file);
    if (report.module != lesson.head.module)
      throw Error(ExitCode::usage, file, "module", report.module + ", but the recording is of " + lesson.head.module);
    experts.push_back(report.motion);
  }
  lesson.head.language = parsed.params<ScoreParams>().language;
  lesson.head.experts = lessons::expert_bands(experts);
  const std::string repeats = lessons::write_report(lesson, parsed.path("case"),
                                                    {parsed.path("json"), parsed.path("page"), parsed.path("log")});
  if (!repeats.empty()) std::cout << "the motion is that of " << repeats << "\n";
  std::cout << lessons::score_text(lesson.head, *lesson.facts, lesson.score);
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand score_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "score";
  c.summary = "judges a recorded lesson by a rubric";
  c.description =
      "Replays the recording in the case, and scores what happened by the rubric of that lesson: Table XIII of "
      "the "
      "dissertation for a ventriculostomy. Each row has its measured figure, the limits that were applied, whether "
      "these are the "
      "dissertation's or ours, and the moment at which it was decided. What the case leaves doubtful is not judged. "
      "The same recording, case and rubric give the same bytes, so a session can be judged again years later, by "
      "another rubric as well. Exit code 80 says that it does not replay bit for bit. docs/explanation/lessons.md says "
      "what each "
      "row measures.";
  cli::Argument recording = cli::argument("recording", Kind::in_file, "The recording of a lesson.");
  recording.positional = recording.required = true;
  cli::Argument folder = cli::argument("case", Kind::in_folder, "Folder of the case in which it was done.");
  cli::Argument rubric =
      cli::argument("rubric", Kind::in_file, "The rubric, as `trephine rubric` compiled it (.json).");
  folder.required = rubric.required = true;
  cli::Argument expert =
      cli::argument("expert", Kind::in_file,
                    "Report (.json) of a recording that the teacher calls an expert's: figures of the "
                    "hand's motion are shown beside those of all that are given.");
  expert.repeated = true;
  c.arguments = {recording,
                 folder,
                 rubric,
                 cli::argument("signed_by", Kind::in_file,
                               "A teacher's public key (PEM): say whether the recording is signed, and refuse a wrong "
                               "signature."),
                 cli::argument("json", Kind::out_file, "Write the report to this file."),
                 cli::argument("page", Kind::out_file, "Write the report as a page (.html) that a person reads."),
                 cli::argument("log", Kind::out_file, "Add the attempt to this log (.csv), for statistics."),
                 expert};
  c.groups = {cli::ParameterGroup::of<ScoreParams>("Parameters")};
  c.examples = {
      "trephine-sim score one.lesson --case library/sample --rubric ventriculostomy.rubric.json --json one.json "
      "--page one.html --log attempts.csv"};
  c.run = run_score;
  return c;
});

}  // namespace trephine::commands
