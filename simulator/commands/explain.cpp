// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>

#include "base/error.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "lessons/lesson_guide.h"
#include "session/felt_case.h"

namespace trephine::commands {
namespace {

struct ExplainParams {
  std::string lesson = "ventriculostomy", task;
  texts::Language language = texts::Language::english;
  template <class V>
  static void describe(V& v) {
    using P = ExplainParams;
    v.word(&P::lesson, "lesson", lessons::lesson_names(), "Which lesson.");
    v.text(&P::task, "task", "What is asked for, as `right` or `pedicle_2_left`; by default the usual.");
    v.choice(&P::language, "language", texts::languages(), "In which language.");
  }
};

ExitCode run_explain(const cli::ParsedCommand& parsed) {
  const ExplainParams& p = parsed.params<ExplainParams>();
  const session::FeltCase felt(parsed.path("case"), "");
  const lessons::LessonType& type = lessons::lesson_type(p.lesson);
  const lessons::LessonBriefing briefing = with_file((parsed.path("case") / "case.json").string(),
                                                     [&] { return lessons::briefing_of(type, felt.loaded, p.task); });
  std::cout << lessons::briefing_text(type, briefing, p.language);
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand explain_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "explain";
  c.summary = "says what a lesson asks for in a case, step by step, with the reason and the sign of each";
  c.description =
      "What a participant should know before a lesson: its task, why it is done, the tools, and the steps: what to do, "
      "why, and how one sees that it is right. The window of `play --lesson` shows the same beside the work, and a "
      "lesson's report repeats it.";
  c.arguments = {cli::positional_argument("case", Kind::in_folder, "Folder of the case.")};
  c.groups = {cli::ParameterGroup::of<ExplainParams>("Parameters")};
  c.examples = {"trephine-sim explain library/sample",
                "trephine-sim explain library/sample --lesson ventriculostomy --task left --language de"};
  c.run = run_explain;
  return c;
});

}  // namespace trephine::commands
