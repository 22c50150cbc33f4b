// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/report.h"
#include "cli/command.h"
#include "stages/stage.h"

namespace trephine {

/// A stage as a command of its own, on files, as its declaration says: the first port is the positional argument, each
/// other port a flag (one of any number, "shape.*", is `--shape NAME=FILE`, repeated), the output goes to --output, the
/// report to stdout and, as JSON, to --report. Beside a file of landmarks single ones may be given: --landmark
/// NAME=X,Y,Z, which win over the file's.
Command make_stage_command(const StageType& stage);

/// The stage's inputs as the command line gives them, read from their files.
StageInputs stage_inputs(const StageType& stage, const ParsedCommand& parsed, const Progress& progress = {});

/// Runs `work` under the progress display, then prints the report, and its warnings on stderr. For commands with a
/// --report argument.
void run_with_report(const ParsedCommand& parsed, const std::function<Report(const Progress&)>& work);

/// The argument that run_with_report reads.
Argument report_argument();

}  // namespace trephine
