// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/report.h"
#include "cli/command.h"
#include "stages/stage.h"

namespace trephine {

/// A stage as a command of its own, on files: the first port is the positional argument, each other port a flag, the
/// output goes to --output, the report to stdout and, as JSON, to --report.
Command make_stage_command(const StageType& stage, std::vector<std::string> examples);

/// Runs `work` under the progress display, then prints the report, and its warnings on stderr. For commands with a
/// --report argument.
void run_with_report(const ParsedCommand& parsed, const std::function<Report(const Progress&)>& work);

/// The argument that run_with_report reads.
Argument report_argument();

}  // namespace trephine
