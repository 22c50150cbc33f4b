// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "lessons/lesson_type.h"
#include "lessons/score_report.h"

namespace trephine::lessons {

/// The columns of a log of attempts with a line of help each, in order (docs/reference/attempts.md): those of every
/// lesson, the rows, and the module's own. A name ends in its unit; what was not judged or never happened is empty.
std::vector<std::pair<std::string, std::string>> attempt_columns(const LessonType& module);

/// One line of the log, with the attempt's number.
std::string attempt_line(const ReportHead& head, const LessonFacts& facts, const LessonScore& score, int attempt,
                         const std::string& repeats = "");

/// Adds the attempt to the log, a CSV file that is made where there is none. The same motion scored by the same
/// rubric, and checked as well, is there once. The attempt's number counts the participant's motions of the module,
/// in lines without a motion the recordings. `repeats`: whose other recording has the motion, "r-01, attempt 2".
/// Several processes may add to one log. Returns the number. Throws Error 65 where the file has other columns, as a log
/// of another module has; 73 and 74.
int log_attempt(const std::filesystem::path& file, const ReportHead& head, const LessonFacts& facts,
                const LessonScore& score, std::string* repeats = nullptr);

}  // namespace trephine::lessons
