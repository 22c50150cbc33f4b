// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/results.h"
#include "study/table.h"

namespace trephine::commands {

/// The results as a table for `study`: a row for each attempt, with who, what, group, level and phase, the points, the
/// rows' scores, and everything that was measured. What an attempt does not have is empty. Columns that are empty
/// everywhere are left out.
study::Table table_of(const lessons::Results& results);

}  // namespace trephine::commands
