// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lessons/exercise_plan.h"
#include "lessons/signature.h"

namespace trephine::lessons {

/// A row of a report.
struct ResultRow {
  std::string name, title;
  std::optional<int> score;  ///< none: not judged
};

/// What a report of a lesson says (score_json), and the participant's plan of it.
struct AttemptResult {
  std::string report;  ///< the file's name without its extension
  std::string participant, module, case_token, task, outcome, reason, checked, seal, recording_sha256, motion_sha256,
      rubric_sha256, announced_rubric_sha256;
  std::string group, level, phase;  ///< of the plan; empty: it says none
  int attempt = 1;                  ///< counts the participant's motions of the module, in the plan's order
  int points = 0, most_points = 0;
  double procedure_s = 0;
  std::vector<ResultRow> rows;
  std::vector<std::string> critical;  ///< the critical errors' names
  /// Everything that was measured, by names that end in the unit: of the rows, what studies count (yes is 1), and of
  /// the hand's motion. A name that several have is there once.
  std::vector<std::pair<std::string, double>> figures;
  std::vector<std::pair<std::string, double>> motion;  ///< those of them that are of the hand's motion
  std::filesystem::path folder;
  bool recording_is_there = false;  ///< beside the report
  Signature signature =
      Signature::not_asked;  ///< asked by score_anew() alone; `fits`: these points are of what is signed
  std::optional<double> figure(const std::string& name) const;
};

/// The results of a group, as `exercise`, `play` and `score` leave them in a folder.
struct Results {
  std::vector<AttemptResult> attempts;  ///< by participant, module and attempt
  std::vector<ExercisePlan> plans;
  std::vector<texts::Phrase> notes;  ///< reports that are left out and why, recordings that are gone
};

/// Numbers the attempts of each participant in a module, in their order. Of several with one motion the first stands,
/// and the others are left out and noted.
void number_attempts(Results& all);

/// Reads one report. Throws Error 65 where it is none, 66.
AttemptResult read_report(const std::filesystem::path& file);

/// The same of its text; the names of files stay empty. Throws Error 65.
AttemptResult parse_report(std::string_view json);

/// Throws Error 65, naming a report of each, where attempts of one lesson were scored by several rubrics: their points
/// are of different things.
void require_one_rubric(const Results& results);

/// Reads all reports and plans of a folder, not of folders in it. A file that is no report is passed over; a report
/// that is damaged is left out and noted, and so is one whose motion another report has. Throws Error 66 where the
/// folder cannot be read, or holds no report and no plan.
Results read_results(const std::filesystem::path& folder);

}  // namespace trephine::lessons
