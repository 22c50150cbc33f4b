// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>

#include "base/error.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "lessons/results.h"
#include "lessons/score_drilled.h"
#include "lessons/score_outcome.h"
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

// Of what was made elsewhere, in another program or in an operating room.
struct ScoreMadeParams {
  std::string participant, task;
  texts::Language language = texts::Language::english;
  template <class V>
  static void describe(V& v) {
    using P = ScoreMadeParams;
    v.text(&P::participant, "participant", "Who made it: a token (a-z, 0-9, _ and -), never a name.");
    v.text(&P::task, "task",
           "What was asked for, such as right or, of several screws, pedicle_2_left; empty: the side or level at which "
           "it was "
           "done, where that is one.");
    v.choice(&P::language, "language", texts::languages(), "Language of the page and of the table.");
  }
};

ExitCode report(const lessons::ScoredLesson& lesson, const cli::ParsedCommand& parsed, const std::string& what) {
  const std::string repeats = lessons::write_report(lesson, parsed.path("case"),
                                                    {parsed.path("json"), parsed.path("page"), parsed.path("log")});
  if (!repeats.empty()) std::cout << what << " is that of " << repeats << "\n";
  std::cout << lessons::score_text(lesson.head, *lesson.facts, lesson.score);
  return ExitCode::ok;
}

// Judges by `score` (score_drilled, score_outcome) what the argument `input` names.
template <class Score>
ExitCode run_score_made(const cli::ParsedCommand& parsed, const Score& score, const char* input, const char* what) {
  const lesson::CompiledRubric rubric = lessons::read_rubric_file(parsed.path("rubric"));
  const auto& params = parsed.params<ScoreMadeParams>();
  lessons::ScoredLesson lesson =
      score(parsed.path(input), parsed.path("case"), rubric, params.participant, params.task);
  lesson.head.language = params.language;
  return report(lesson, parsed, what);
}

// The input and what all three commands take.
std::vector<cli::Argument> arguments_of(const char* input, const char* is, const char* of_case) {
  using Kind = cli::Argument::Kind;
  return {cli::positional_argument(input, Kind::in_file, is),
          cli::required_argument("case", Kind::in_folder, of_case),
          cli::required_argument("rubric", Kind::in_file, "The rubric, as `trephine rubric` compiled it (.json)."),
          cli::argument("json", Kind::out_file, "Write the report to this file."),
          cli::argument("page", Kind::out_file, "Write the report as a page (.html) that a person reads."),
          cli::argument("log", Kind::out_file, "Add the attempt to this log (.csv), for statistics.")};
}

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
  return report(lesson, parsed, "the motion");
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
  cli::Argument expert =
      cli::argument("expert", Kind::in_file,
                    "Report (.json) of a recording that the teacher calls an expert's: figures of the "
                    "hand's motion are shown beside those of all that are given.");
  expert.repeated = true;
  c.arguments = arguments_of("recording", "The recording of a lesson.", "Folder of the case in which it was done.");
  c.arguments.insert(c.arguments.begin() + 3,
                     cli::argument("signed_by", Kind::in_file,
                                   "A teacher's public key (PEM): say whether the recording is signed, and refuse a "
                                   "wrong signature."));
  c.arguments.push_back(expert);
  c.groups = {cli::ParameterGroup::of<ScoreParams>("Parameters")};
  c.examples = {
      "trephine-sim score one.lesson --case library/sample --rubric ventriculostomy.rubric.json --json one.json "
      "--page one.html --log attempts.csv"};
  c.run = run_score;
  return c;
});

const cli::OwnCommand score_drilled_command([] {
  cli::Command c;
  c.name = "score-drilled";
  c.summary = "judges what was drilled in another program by the rubric of the lesson";
  c.description =
      "Takes the labels that `trephine drilled` made of a stack which volumetric_drilling saved, and scores them by "
      "the same functions and the same rubric as a recorded lesson, in the anatomy of the case. What a drilled volume "
      "does not show (traces of landmarks, the catheter, time, passes) is not judged. The report holds each hole's "
      "place and volume, and is one that `study` and `group` read beside those of lessons.";
  c.arguments = arguments_of("labels", "The labels (.seg.nrrd).", "Folder of the case that was drilled.");
  c.groups = {cli::ParameterGroup::of<ScoreMadeParams>("Parameters")};
  c.examples = {
      "trephine-sim score-drilled drilled.seg.nrrd --case library/head-01 --rubric ventriculostomy.rubric.json "
      "--participant r-01 --json results/r-01-ambf.json --log attempts.csv"};
  c.run = [](const cli::ParsedCommand& parsed) {
    return run_score_made(parsed, lessons::score_drilled, "labels", "the drilled volume");
  };
  return c;
});

const cli::OwnCommand score_outcome_command([] {
  cli::Command c;
  c.name = "score-outcome";
  c.summary = "judges what a CT after a procedure shows by the rubric of the lesson";
  c.description =
      "Takes outcome.json, which `trephine outcome` measured on a CT after a ventriculostomy, with pedicle screws or "
      "with a central line, and scores it by the same "
      "functions and the same rubric as a recorded lesson, in the anatomy of the case. What a CT does not show (traces "
      "of landmarks, time, passes) is not judged, and neither is what was found doubtfully. The report is one that "
      "`study` and `group` read beside those of lessons. For training and research; not for clinical use.";
  c.arguments = arguments_of("outcome", "outcome.json.", "Folder of the case in which it was measured.");
  c.groups = {cli::ParameterGroup::of<ScoreMadeParams>("Parameters")};
  c.examples = {
      "trephine-sim score-outcome after/outcome.json --case library/head-01 --rubric ventriculostomy.rubric.json "
      "--participant r-01 --json results/r-01-real.json --log attempts.csv"};
  c.run = [](const cli::ParsedCommand& parsed) {
    return run_score_made(parsed, lessons::score_outcome, "outcome", "the outcome");
  };
  return c;
});

}  // namespace trephine::commands
