// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/report.h"
#include "cli/command.h"
#include "stages/stage.h"

namespace trephine::tools {

/// Makes a command of a stage, working on files, from the stage's declaration. The first port is the positional
/// argument, each other port is a flag (a port of any number, "shape.*", is `--shape NAME=FILE`, repeated). The output
/// goes to --output, the report to stdout and, as JSON, to --report. Beside a file of landmarks single ones may be
/// given: --landmark NAME=X,Y,Z, which replace those of the file.
cli::Command make_stage_command(const stages::StageType& stage);

/// The stage's inputs, read from the files that the command line names.
stages::StageInputs stage_inputs(const stages::StageType& stage, const cli::ParsedCommand& parsed);

/// Runs `work` under the progress display, then prints the report, with its warnings on stderr. For commands with a
/// --report argument.
void run_with_report(const cli::ParsedCommand& parsed, const std::function<Report(const Progress&)>& work);

/// The argument that run_with_report reads.
cli::Argument report_argument();

}  // namespace trephine::tools
