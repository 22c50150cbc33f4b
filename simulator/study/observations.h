// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "study/study.h"

namespace trephine::study::detail {

/// A row of the table as a study takes it.
struct Observation {
  std::string participant, group, phase;
  int attempt = 0;                              ///< 0: the table has no such column
  std::vector<std::optional<double>> measures;  ///< in the order of Observations::measures
  std::optional<bool> acceptable;
  std::size_t line = 0;
};

struct Observations {
  std::vector<std::string> measures;
  std::vector<Observation> rows;
  bool has_participants = false, has_groups = false, has_phases = false, has_attempts = false;
  std::vector<std::string> groups, phases;  ///< in their order
  std::vector<int> attempts;
  std::vector<std::string> notes;
  /// A participant's rows are one observation of a group.
  bool by_participant(const StudyParams& params) const {
    return has_participants && params.unit == StudyParams::Unit::participant;
  }
};
/// Throws as evaluate().
Observations observations_of(const Table& table, const StudyParams& params);

/// "r-01, r-02 and 3 more".
std::string some_of(const std::vector<std::string>& names);

Comparison compare_groups(const Observations& all, std::size_t measure, const std::string& phase,
                          const StudyParams& params);
/// `of` names each row's phase or attempt; levels in their order.
Comparison compare_within(const Observations& all, std::size_t measure, const std::string& by,
                          const std::vector<std::string>& levels, const StudyParams& params);
LearningCurve curve_of(const Observations& all, std::size_t measure, const StudyParams& params);
std::vector<AcceptableRow> acceptable_of(const Observations& all, const StudyParams& params);
std::vector<AcceptableChange> acceptable_changes_of(const Observations& all, const StudyParams& params);

}  // namespace trephine::study::detail
