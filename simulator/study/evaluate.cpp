// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "study/observations.h"

namespace trephine::study {
namespace {

using detail::Observation;
using detail::Observations;

// Whose rows lack a value, and how often the rest says the same.
void tell_values(const Observations& all, std::size_t measure, MeasureStudy& study) {
  std::vector<std::string> whose;
  std::set<std::string> named;
  std::set<double> different;
  for (const Observation& o : all.rows) {
    if (o.measures[measure]) {
      ++study.values_count;
      different.insert(*o.measures[measure]);
      continue;
    }
    const std::string who = o.participant.empty() ? "line " + std::to_string(o.line) : o.participant;
    if (named.insert(who).second) whose.push_back(who);
  }
  if (const std::size_t missing = all.rows.size() - study.values_count; missing > 0)
    study.notes.push_back(fmt::format("{} of {} rows {} no value, and {} left out: {}", missing, all.rows.size(),
                                      missing == 1 ? "has" : "have", missing == 1 ? "is" : "are",
                                      detail::some_of(whose)));
  if (different.size() == 1)
    study.notes.push_back(fmt::format("all values are equal ({:g}): there is nothing to compare", *different.begin()));
}

MeasureStudy study_of(const Observations& all, std::size_t measure, const StudyParams& params) {
  MeasureStudy study;
  study.name = all.measures[measure];
  tell_values(all, measure, study);
  if (all.has_groups) {
    if (all.has_phases)
      for (const std::string& phase : all.phases)
        study.comparisons.push_back(detail::compare_groups(all, measure, phase, params));
    else
      study.comparisons.push_back(detail::compare_groups(all, measure, "", params));
  }
  if (all.has_participants && all.has_phases)
    study.comparisons.push_back(detail::compare_within(all, measure, "phase", all.phases, params));
  if (all.has_participants && all.has_attempts) {
    std::vector<std::string> attempts;
    for (const int attempt : all.attempts) attempts.push_back(std::to_string(attempt));
    study.comparisons.push_back(detail::compare_within(all, measure, "attempt", attempts, params));
    study.curve = detail::curve_of(all, measure, params);
  }
  if (study.comparisons.empty())
    study.notes.push_back("the table has neither two groups nor two phases nor two attempts: nothing is compared");
  return study;
}

}  // namespace

Study evaluate(const Table& table, const StudyParams& params) {
  const Observations all = detail::observations_of(table, params);
  Study study;
  study.params = params;
  study.rows_count = all.rows.size();
  study.notes = all.notes;
  std::set<std::string> participants;
  for (const Observation& o : all.rows)
    if (!o.participant.empty()) participants.insert(o.participant);
  study.participants_count = participants.size();
  if (all.rows.empty()) study.notes.push_back("no row is left: nothing can be evaluated");
  for (std::size_t m = 0; m < all.measures.size(); ++m) study.measures.push_back(study_of(all, m, params));
  if (!params.acceptable.empty()) study.acceptable = detail::acceptable_of(all, params);
  if (!params.acceptable.empty() && all.has_participants)
    study.acceptable_changes = detail::acceptable_changes_of(all, params);
  if (study.measures.size() > 1)
    study.notes.push_back(
        fmt::format("{} measures are evaluated; p values are corrected within a comparison, not over "
                    "measures",
                    study.measures.size()));
  return study;
}

namespace detail {

std::vector<AcceptableRow> acceptable_of(const Observations& all, const StudyParams& params) {
  std::vector<AcceptableRow> rows;
  const std::vector<std::string> names = all.groups.empty() ? std::vector<std::string>{"all"} : all.groups;
  for (const std::string& name : names) {
    AcceptableRow row;
    row.name = name;
    for (const Observation& o : all.rows)
      if (o.acceptable && (all.groups.empty() || o.group == name)) {
        ++row.all;
        row.acceptable += *o.acceptable;
      }
    if (row.all == 0) continue;
    row.interval = share_interval(row.acceptable, row.all, params.confidence_ratio);
    rows.push_back(row);
  }
  std::vector<double> p;
  for (std::size_t n = 1; n < rows.size(); ++n) {
    AcceptableRow& row = rows[n];
    row.more_points_percent = 100 * (row.share() - rows[0].share());
    if (rows[0].acceptable > 0) row.relative_ratio = row.share() / rows[0].share() - 1;
    row.fisher_p = fisher_p(rows[0].acceptable, rows[0].all, row.acceptable, row.all);
    p.push_back(*row.fisher_p);
  }
  const std::vector<double> by_all = corrected(p, params.correction);
  for (std::size_t n = 1; n < rows.size(); ++n) rows[n].corrected_p = by_all[n - 1];
  return rows;
}

std::vector<AcceptableChange> acceptable_changes_of(const Observations& all, const StudyParams& params) {
  std::map<std::string, std::map<std::string, std::vector<bool>>> of;  // by phase and participant
  for (const Observation& o : all.rows)
    if (o.acceptable) of[o.phase][o.participant].push_back(*o.acceptable);
  std::vector<AcceptableChange> changes;
  std::vector<double> p;
  for (std::size_t a = 0; a < all.phases.size(); ++a)
    for (std::size_t b = a + 1; b < all.phases.size(); ++b) {
      AcceptableChange change;
      change.from = all.phases[a];
      change.to = all.phases[b];
      for (const auto& [participant, before] : of[change.from]) {
        const auto after = of[change.to].find(participant);
        if (after == of[change.to].end()) continue;
        if (before.size() > 1 || after->second.size() > 1) {
          ++change.several;
          continue;
        }
        ++change.pairs_count;
        change.gained += !before[0] && after->second[0];
        change.lost += before[0] && !after->second[0];
      }
      if (change.gained + change.lost > 0) {
        change.mcnemar_p = mcnemar_p(change.gained, change.lost);
        p.push_back(*change.mcnemar_p);
      }
      changes.push_back(change);
    }
  const std::vector<double> by_all = corrected(p, params.correction);
  std::size_t n = 0;
  for (AcceptableChange& change : changes)
    if (change.mcnemar_p) change.corrected_p = by_all[n++];
  return changes;
}

}  // namespace detail
}  // namespace trephine::study
