// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>

#include "base/own_files.h"
#include "base/spawn.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "library/approve.h"

namespace trephine::tools {
namespace {

struct ApproveParams {
  int difficulty_level = 3;
  bool withdraw = false;
  template <class V>
  static void describe(V& v) {
    using P = ApproveParams;
    v.integer(&P::difficulty_level, "difficulty_level", Range{1, 5}, "How difficult the case is: 1 easy to 5 hard.");
    v.flag(&P::withdraw, "withdraw", "Take the approval back.");
  }
};

// Which lessons the case can serve, as the simulator says it: it alone knows the lessons.
void tell_lessons(const std::filesystem::path& case_folder) {
  const std::filesystem::path simulator = own_file({"trephine-sim"});
  if (simulator.empty()) {
    std::cout << "which lessons it serves is not said: trephine-sim does not lie beside trephine\n";
    return;
  }
  std::cout << std::flush;
  SpawnRequest request;
  request.argv = {simulator.string(), "lessons", case_folder.string()};
  request.shares_stdout = request.shares_stderr = true;
  wait_for(spawn(request), until_it_ends_s);
}

}  // namespace

const cli::OwnCommand library_approve_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "library approve";
  c.summary = "says that lessons may use a case, after a person has looked at it";
  c.description =
      "Writes approved.json beside the case, with the reviewer's token, the case's difficulty and the SHA-256 of "
      "case.json: when the case changes, the approval is void. `trephine-sim exercise` uses approved cases only. The "
      "case is checked as a simulator checks it, and it is said which lessons it can serve, and why others it cannot.";
  c.examples = {"trephine library approve library/normal-1 --by reviewer-2 --difficulty-level 2",
                "trephine library approve library/normal-1 --by reviewer-2 --withdraw"};
  const cli::Argument folder = cli::positional_argument("case", Kind::in_folder, "The case's folder.");
  const cli::Argument by =
      cli::required_argument("by", Kind::text, "Token of the reviewer: a-z, 0-9, _ and -; never a name.");
  c.arguments = {folder, by};
  c.groups = {cli::ParameterGroup::of<ApproveParams>("Parameters")};
  c.run = [](const cli::ParsedCommand& parsed) {
    const ApproveParams& p = parsed.params<ApproveParams>();
    if (!p.withdraw && !parsed.quiet) tell_lessons(parsed.path("case"));
    const std::string done = p.withdraw
                                 ? library::withdraw_approval(parsed.path("case"), parsed.text("by"))
                                 : library::approve_case(parsed.path("case"), parsed.text("by"), p.difficulty_level);
    if (!parsed.quiet) std::cout << done << "\n";
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
