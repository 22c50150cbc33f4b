// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/score_outcome.h"

#include <iostream>

#include "cli/argument.h"
#include "cli/command.h"

namespace trephine::commands {
namespace {

struct ScoreOutcomeParams {
  std::string participant, task;
  texts::Language language = texts::Language::english;
  template <class V>
  static void describe(V& v) {
    using P = ScoreOutcomeParams;
    v.text(&P::participant, "participant", "Whose procedure it was: a token (a-z, 0-9, _ and -), never a name.");
    v.text(&P::task, "task",
           "What was asked for, such as right or pedicle_2_left; empty: what was done. Of several screws, or "
           "lines on both sides, it names one.");
    v.choice(&P::language, "language", texts::languages(), "Language of the page and of the table.");
  }
};

ExitCode run_score_outcome(const cli::ParsedCommand& parsed) {
  const lesson::CompiledRubric rubric = lessons::read_rubric_file(parsed.path("rubric"));
  const auto& params = parsed.params<ScoreOutcomeParams>();
  lessons::ScoredLesson lesson =
      lessons::score_outcome(parsed.path("outcome"), parsed.path("case"), rubric, params.participant, params.task);
  lesson.head.language = params.language;
  const std::string repeats = lessons::write_report(lesson, parsed.path("case"),
                                                    {parsed.path("json"), parsed.path("page"), parsed.path("log")});
  if (!repeats.empty()) std::cout << "the outcome is that of " << repeats << "\n";
  std::cout << lessons::score_text(lesson.head, *lesson.facts, lesson.score);
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand score_outcome_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "score-outcome";
  c.summary = "judges what a CT after a procedure shows by the rubric of the lesson";
  c.description =
      "Takes outcome.json, which `trephine outcome` measured on a CT after a ventriculostomy, with pedicle screws or "
      "with a central line, and scores it by the same "
      "functions and the same rubric as a recorded lesson, in the anatomy of the case. What a CT does not show (traces "
      "of landmarks, time, passes) is not judged, and neither is what was found doubtfully. The report is one that "
      "`study` and `group` read beside those of lessons. For training and research; not for clinical use.";
  c.arguments = {
      cli::positional_argument("outcome", Kind::in_file, "outcome.json."),
      cli::required_argument("case", Kind::in_folder, "Folder of the case in which it was measured."),
      cli::required_argument("rubric", Kind::in_file, "The rubric, as `trephine rubric` compiled it (.json)."),
      cli::argument("json", Kind::out_file, "Write the report to this file."),
      cli::argument("page", Kind::out_file, "Write the report as a page (.html) that a person reads."),
      cli::argument("log", Kind::out_file, "Add it to this log of attempts (.csv), for statistics.")};
  c.groups = {cli::ParameterGroup::of<ScoreOutcomeParams>("Parameters")};
  c.examples = {
      "trephine-sim score-outcome after/outcome.json --case library/head-01 --rubric ventriculostomy.rubric.json "
      "--participant r-01 --json results/r-01-real.json --log attempts.csv"};
  c.run = run_score_outcome;
  return c;
});

}  // namespace trephine::commands
