// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

#include "base/error.h"
#include "base/log.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/progress_display.h"
#include "commands.h"
#include "compare/compare_cases.h"

namespace trephine {

Command diff_command() {
  using Kind = Argument::Kind;
  Command c;
  c.name = "diff";
  c.summary = "says what changed between two versions of a case";
  c.description =
      "Reads two cases, checks every byte of both as a simulator does, and says for each anatomy how far the new "
      "surface lies from the old one (two-sided, in mm; the bias is positive where the new one lies outside) and how "
      "its volume changed, how far landmarks, targets and burr holes moved, and which figures, materials and effective "
      "parameters are others. A shape that is displayed from the haptic volume is compared by the surface that is "
      "felt. The cases may hold different anatomies.\n\n"
      "The exit code is 0 whatever differs, and 80 where a limit is given and something exceeds it, or cannot be "
      "judged because only one of the cases holds it; 65 or 66 where a case is damaged or missing.";
  c.examples = {"trephine diff library/head-01 trial/head-01",
                "trephine diff library/head-01 trial/head-01 --json changes.json --max-deviation-mm 0.5",
                "trephine diff old/head-01 new/head-01 --quiet --max-deviation-mm 0.3 --max-point-mm 1"};
  Argument old_case = argument("old", Kind::in_folder, "The older case's folder.");
  Argument new_case = argument("new", Kind::in_folder, "The newer case's folder.");
  old_case.positional = new_case.positional = old_case.required = new_case.required = true;
  c.arguments = {old_case, new_case, argument("json", Kind::out_file, "Write everything that was compared as JSON.")};
  c.groups = {ParameterGroup::of<CompareParams>("Parameters")};
  c.run = [](const ParsedCommand& parsed) {
    const auto& params = parsed.params<CompareParams>();
    CaseComparison comparison;
    {
      ProgressDisplay display(parsed.quiet);
      const Progress progress = display.start("diff");
      const LoadedCase old_loaded = load_case(parsed.path("old")), new_loaded = load_case(parsed.path("new"));
      comparison = compare_cases(old_loaded, new_loaded, params, progress);
      display.finish("diff", "");
    }
    for (const std::string& w : comparison.warnings) log_warning(w);
    if (parsed.has("json")) write_file(parsed.path("json"), comparison_json(comparison));
    if (!parsed.quiet) std::fputs(comparison_text(comparison).c_str(), stdout);
    const std::vector<std::string> beyond = beyond_limits(comparison, params);
    if (!beyond.empty())
      throw Error(ExitCode::quality, parsed.text("new"), "",
                  beyond[0] + (beyond.size() > 1 ? " (and " + std::to_string(beyond.size() - 1) + " more)" : ""));
    return ExitCode::ok;
  };
  return c;
}

}  // namespace trephine
