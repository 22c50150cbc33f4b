// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cli/command.h"
#include "lessons/results.h"
#include "study/table.h"

namespace trephine::commands {

/// The arguments `cases`, `rubric`, `scores_cache` and `signed_by` of commands that read results.
std::vector<cli::Argument> anew_arguments();
/// Scores the results anew where those were given, and refuses a mixture of rubrics. Throws Error 64 where one of the
/// first two is missing; else as score_anew and require_one_rubric do.
void score_anew(lessons::Results& results, const cli::ParsedCommand& parsed);

/// The results as a table for `study`: a row for each attempt, with who, what, group, level and phase, the points, the
/// rows' scores, and everything that was measured. What an attempt does not have is empty. Columns that are empty
/// everywhere are left out.
study::Table table_of(const lessons::Results& results);

}  // namespace trephine::commands
