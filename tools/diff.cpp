// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>

#include "base/error.h"
#include "base/log.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "cli/progress_display.h"
#include "compare/compare_cases.h"
#include "compare/compare_libraries.h"

namespace trephine::tools {
namespace {

struct Compared {
  std::string text, json;
  std::vector<std::string> warnings, beyond;
  ExitCode code = ExitCode::quality;
};

Compared compare_two_cases(const cli::ParsedCommand& parsed, const compare::CompareParams& params,
                           const Progress& progress) {
  const cases::LoadedCase old_case = cases::load_case(parsed.path("old")),
                          new_case = cases::load_case(parsed.path("new"));
  const compare::CaseComparison made = compare::compare_cases(old_case, new_case, params, progress);
  return {compare::comparison_text(made), compare::comparison_json(made), made.warnings,
          compare::beyond_limits(made, params), ExitCode::quality};
}

Compared compare_two_libraries(const cli::ParsedCommand& parsed, const compare::CompareParams& params,
                               const Progress& progress) {
  const auto made = compare::compare_libraries(parsed.path("old"), parsed.path("new"), params, progress);
  Compared out{compare::libraries_text(made),
               compare::libraries_json(made),
               {},
               compare::beyond_limits(made, params),
               ExitCode::quality};
  for (const compare::LibraryCaseChange& c : made) {
    if (!c.fault.empty()) out.code = ExitCode::bad_input;
    for (const std::string& w : c.comparison.warnings) out.warnings.push_back(c.token + ": " + w);
  }
  return out;
}

}  // namespace

const cli::OwnCommand diff_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "diff";
  c.summary = "says what changed between two versions of a case";
  c.description =
      "Reads two cases, checks every byte of both as a simulator does, and says for each anatomy how far the new "
      "surface lies from the old one (two-sided, in mm; the bias is positive where the new one lies outside) and how "
      "its volume changed, how far landmarks, targets and burr holes moved, and which figures, materials and effective "
      "parameters are others. A shape that is displayed from the haptic volume is compared by the surface that is "
      "felt. The cases may hold different anatomies.\n\n"
      "Of two libraries (folders of cases): a line for each case with what changed most in it.\n\n"
      "The exit code is 0 whatever differs, and 80 where a limit is given and something exceeds it, or cannot be "
      "judged because only one of the cases holds it; 65 or 66 where a case is damaged or missing (of libraries: 65, "
      "after all cases have been compared).";
  c.examples = {"trephine diff library/head-01 trial/head-01",
                "trephine diff library/head-01 trial/head-01 --json changes.json --max-deviation-mm 0.5",
                "trephine diff library trial --json changes.json",
                "trephine diff old/head-01 new/head-01 --quiet --max-deviation-mm 0.3 --max-point-mm 1"};
  const cli::Argument old_case =
      cli::positional_argument("old", Kind::in_folder, "The older case's folder, or the older library.");
  const cli::Argument new_case =
      cli::positional_argument("new", Kind::in_folder, "The newer case's folder, or the newer library.");
  c.arguments = {old_case, new_case,
                 cli::argument("json", Kind::out_file, "Write everything that was compared as JSON.")};
  c.groups = {cli::ParameterGroup::of<compare::CompareParams>("Parameters")};
  c.run = [](const cli::ParsedCommand& parsed) {
    const auto& params = parsed.params<compare::CompareParams>();
    const bool libraries = compare::is_library(parsed.path("old")) && compare::is_library(parsed.path("new"));
    Compared made;
    {
      cli::ProgressDisplay display(parsed.quiet);
      const Progress progress = display.start("diff");
      made = libraries ? compare_two_libraries(parsed, params, progress) : compare_two_cases(parsed, params, progress);
      display.finish("diff", "");
    }
    for (const std::string& w : made.warnings) log_warning(w);
    if (parsed.has("json")) write_file(parsed.path("json"), made.json);
    if (!parsed.quiet) std::cout << made.text;
    const std::vector<std::string>& beyond = made.beyond;
    if (!beyond.empty())
      throw Error(made.code, parsed.text("new"), "",
                  beyond[0] + (beyond.size() > 1 ? " (and " + std::to_string(beyond.size() - 1) + " more)" : ""));
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
