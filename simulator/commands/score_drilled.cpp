// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/score_drilled.h"

#include <iostream>

#include "cli/argument.h"
#include "cli/command.h"

namespace trephine::commands {
namespace {

struct ScoreDrilledParams {
  std::string participant, task;
  texts::Language language = texts::Language::english;
  template <class V>
  static void describe(V& v) {
    using P = ScoreDrilledParams;
    v.text(&P::participant, "participant", "Who drilled: a token (a-z, 0-9, _ and -), never a name.");
    v.text(&P::task, "task", "What was asked for, such as right; empty: the side on which it was done.");
    v.choice(&P::language, "language", texts::languages(), "Language of the page and of the table.");
  }
};

ExitCode run_score_drilled(const cli::ParsedCommand& parsed) {
  const lesson::CompiledRubric rubric = lessons::read_rubric_file(parsed.path("rubric"));
  const auto& params = parsed.params<ScoreDrilledParams>();
  lessons::ScoredLesson lesson =
      lessons::score_drilled(parsed.path("labels"), parsed.path("case"), rubric, params.participant, params.task);
  lesson.head.language = params.language;
  const std::string repeats = lessons::write_report(lesson, parsed.path("case"),
                                                    {parsed.path("json"), parsed.path("page"), parsed.path("log")});
  if (!repeats.empty()) std::cout << "the drilled volume is that of " << repeats << "\n";
  std::cout << lessons::score_text(lesson.head, *lesson.facts, lesson.score);
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand score_drilled_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "score-drilled";
  c.summary = "judges what was drilled in another program by the rubric of the lesson";
  c.description =
      "Takes the labels that `trephine drilled` made of a stack which volumetric_drilling saved, and scores them by "
      "the same functions and the same rubric as a recorded lesson, in the anatomy of the case. What a drilled volume "
      "does not show (traces of landmarks, the catheter, time, passes) is not judged. The report holds each hole's "
      "place and volume, and is one that `study` and `group` read beside those of lessons.";
  c.arguments = {
      cli::positional_argument("labels", Kind::in_file, "The labels (.seg.nrrd)."),
      cli::required_argument("case", Kind::in_folder, "Folder of the case that was drilled."),
      cli::required_argument("rubric", Kind::in_file, "The rubric, as `trephine rubric` compiled it (.json)."),
      cli::argument("json", Kind::out_file, "Write the report to this file."),
      cli::argument("page", Kind::out_file, "Write the report as a page (.html) that a person reads."),
      cli::argument("log", Kind::out_file, "Add it to this log of attempts (.csv), for statistics.")};
  c.groups = {cli::ParameterGroup::of<ScoreDrilledParams>("Parameters")};
  c.examples = {
      "trephine-sim score-drilled drilled.seg.nrrd --case library/head-01 --rubric ventriculostomy.rubric.json "
      "--participant r-01 --json results/r-01-ambf.json --log attempts.csv"};
  c.run = run_score_drilled;
  return c;
});

}  // namespace trephine::commands
