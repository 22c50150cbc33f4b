// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>

#include "base/error.h"
#include "base/own_files.h"
#include "base/spawn.h"
#include "base/text.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "library/approve.h"

namespace trephine::tools {
namespace {

constexpr std::size_t max_reason = 500;

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
    std::cout << "which lessons it serves is not known: trephine-sim is not beside trephine\n";
    return;
  }
  std::cout << std::flush;
  SpawnRequest request;
  request.argv = {simulator.string(), "lessons", case_folder.string()};
  request.shares_stdout = request.shares_stderr = true;
  wait_for(spawn(request), until_it_ends_s);
}

// LESSON[,LESSON...]=REASON, as often as it is given.
std::vector<lesson::AcceptedLesson> accepted_of(const std::vector<std::string>& words) {
  std::vector<lesson::AcceptedLesson> all;
  for (const std::string& word : words) {
    const std::size_t is = word.find('=');
    if (is == std::string::npos) throw Error(ExitCode::usage, "", "--accept", "must be LESSON=REASON");
    std::string names = word.substr(0, is) + ",";
    for (std::size_t at = 0, end; (end = names.find(',', at)) != std::string::npos; at = end + 1)
      all.push_back({names.substr(at, end - at), printable(word.substr(is + 1, max_reason))});
  }
  return all;
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
      "case is checked as a simulator checks it, and the lessons that it can serve are listed, with the reason for "
      "each that it cannot. "
      "A case that cannot serve a lesson is refused with exit code 80 unless --accept says why that is right; the "
      "reasons are kept in approved.json.";
  c.examples = {
      "trephine library approve library/normal-1 --by reviewer-2 --difficulty-level 2 --accept "
      "'pedicle_finder,pedicle_screw,spine_needle,subclavian=a head'",
      "trephine library approve library/normal-1 --by reviewer-2 --withdraw"};
  const cli::Argument folder = cli::positional_argument("case", Kind::in_folder, "The case's folder.");
  const cli::Argument by =
      cli::required_argument("by", Kind::text, "Token of the reviewer: a-z, 0-9, _ and -; never a name.");
  cli::Argument accept = cli::argument("accept", Kind::text,
                                       "A lesson that the case cannot serve, or several with commas between them, and "
                                       "why it is approved all the same: LESSON=REASON.");
  accept.repeated = true;
  c.arguments = {folder, by, accept};
  c.groups = {cli::ParameterGroup::of<ApproveParams>("Parameters")};
  c.run = [](const cli::ParsedCommand& parsed) {
    const ApproveParams& p = parsed.params<ApproveParams>();
    const auto accepted = accepted_of(parsed.all("accept"));
    if (!p.withdraw && !parsed.quiet) tell_lessons(parsed.path("case"));
    const std::string done =
        p.withdraw ? library::withdraw_approval(parsed.path("case"), parsed.text("by"))
                   : library::approve_case(parsed.path("case"), parsed.text("by"), p.difficulty_level, accepted);
    if (!parsed.quiet) std::cout << done << "\n";
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
