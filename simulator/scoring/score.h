// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lesson/rubric.h"
#include "modules/ventriculostomy.h"
#include "scoring/critical_zones.h"

namespace trephine {

/// One row of a rubric's table.
struct ScoreRow {
  std::string name, title;
  std::optional<int> score;                                 ///< 1 to 5; none: not judged
  std::string why;                                          ///< what of the table applies, or why it is not judged
  std::vector<std::pair<std::string, double>> measured;     ///< by names that end in the unit
  std::vector<std::pair<std::string, RubricLimit>> limits;  ///< those by which it was decided
  std::optional<double> decided_s;  ///< when in the recording; none: nothing ever happened that could decide it
};

/// What the table does not score, and what the studies of chapter 8.1 counted.
struct LessonFigures {
  int passes_count = 0;
  bool in_ventricle = false, first_pass = false, contralateral = false, third_ventricle = false;
};

struct LessonScore {
  std::vector<ScoreRow> rows;
  LessonFigures figures;
};

/// Scores a ventriculostomy by Table XIII of the dissertation. A pure function: the same facts, case with its zones,
/// volume as the lesson began, and rubric give the same rows. What a doubtful suture or a hole that was there
/// beforehand leaves open is not judged.
LessonScore score_ventriculostomy(const VentriculostomyFacts& facts, const CaseManifest& manifest,
                                  const HapticVolume& before, const VentriculostomyRubric& rubric,
                                  const CriticalZones& zones = {});

}  // namespace trephine
