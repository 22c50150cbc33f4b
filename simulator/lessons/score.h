// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lesson/rubric.h"

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

/// What the table does not score, and studies count: yes or no, a count, or a measure whose name ends in its unit.
struct LessonFigure {
  std::string name;
  std::variant<bool, int, double, std::monostate> value;  ///< nothing where it could not be judged
};

struct LessonScore {
  std::vector<ScoreRow> rows;
  std::vector<LessonFigure> figures;
  /// The figure of that name; throws Error 70 where the module has none.
  const LessonFigure& figure(const std::string& name) const;
  bool known(const std::string& name) const { return !std::holds_alternative<std::monostate>(figure(name).value); }
  bool flag(const std::string& name) const { return std::get<bool>(figure(name).value); }
  int count(const std::string& name) const { return std::get<int>(figure(name).value); }
};

}  // namespace trephine
