// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/params.h"
#include "study/numbers.h"
#include "study/table.h"

namespace trephine::study {

/// Which columns of a table mean what, and how it is evaluated.
struct StudyParams {
  enum class Unit { participant, row };
  std::string measures, participant = "participant", group = "group", phase = "phase", attempt = "attempt", count,
                        acceptable, only;
  Unit unit = Unit::participant;
  Correction correction = Correction::holm;
  double confidence_ratio = 0.95;
  int bins_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = StudyParams;
    v.text(&P::measures, "measures", "Columns that are evaluated, with commas; empty: every column of numbers.");
    v.text(&P::participant, "participant", "Column of the participants' tokens (a-z, 0-9, _ and -; never a name).");
    v.text(&P::group, "group", "Column of groups, such as residents and students; they are compared as independent.");
    v.text(&P::phase, "phase", "Column of phases, such as before and after; they are compared within participants.");
    v.text(&P::attempt, "attempt", "Column that counts a participant's attempts from 1; gives the learning curve.");
    v.text(&P::count, "count", "Column that says how many such observations a row stands for, as in printed tables.");
    v.text(&P::acceptable, "acceptable", "Column of 1 (acceptable) and 0; gives the table of acceptable results.");
    v.text(&P::only, "only", "Rows that are evaluated, as module=spine_needle,phase=after; empty: all.");
    v.choice(&P::unit, "unit", {{"participant", Unit::participant}, {"row", Unit::row}},
             "What counts as one observation of a group: a participant, by the mean of his rows; or each row, which "
             "takes results of one participant as independent, as the dissertation took two screws.");
    v.choice(&P::correction, "correction",
             {{"holm", Correction::holm}, {"bonferroni", Correction::bonferroni}, {"none", Correction::none}},
             "How p values of several pairs of one comparison are corrected; both are given, corrected and not.");
    v.number(&P::confidence_ratio, "confidence_ratio", Range{0.5, 0.999}, "Of the intervals.");
    v.integer(&P::bins_count, "bins_count", Range{0, 1000}, "Bars of a histogram; 0: by Freedman and Diaconis.");
  }
};

/// Values of one group, phase or attempt.
struct Sample {
  std::string name;
  std::vector<double> values;
  std::vector<std::string> owners;  ///< the participant of each; empty where rows count, or there are none
  Summary summary;
};

struct NamedTest {
  std::string name;
  TestResult result;
  std::optional<double> corrected_p;  ///< within the pairs of the comparison
};
struct PairTests {
  std::size_t first = 0, second = 0;   ///< of the samples
  std::size_t pairs_count = 0;         ///< participants in both; 0 where they are independent
  std::optional<double> change_ratio;  ///< of the mean, over the first's; of paired samples, of those in both
  std::vector<NamedTest> tests;
};
struct Comparison {
  std::string by;     ///< "group", "phase", "attempt"
  std::string phase;  ///< that alone is compared; empty: all
  std::string within() const { return phase.empty() ? "" : "phase " + phase; }
  bool paired = false;
  std::vector<Sample> samples;
  std::optional<NamedTest> all;  ///< Kruskal-Wallis
  std::vector<PairTests> pairs;
  std::vector<std::string> notes;
};

struct CurvePoint {
  int attempt = 1;
  Summary summary;
};
/// A measure over attempts, and the mean of the participants' own slopes over the logarithm of the attempt
/// [Matthews1990]: the change for each doubling of practice.
struct LearningCurve {
  std::vector<CurvePoint> points;
  std::vector<std::vector<std::pair<int, double>>> lines;  ///< of each participant
  TestResult slope;
  std::vector<std::string> notes;
};

struct MeasureStudy {
  std::string name;
  std::size_t values_count = 0;
  std::vector<std::string> notes;  ///< missing values and whose, means that stand for several rows
  std::vector<Comparison> comparisons;
  std::optional<LearningCurve> curve;
};

/// Acceptable results by group, as Table XVI of the dissertation.
struct AcceptableRow {
  std::string name;
  std::size_t acceptable = 0, all = 0;
  Interval interval;
  double share() const { return double(acceptable) / double(all); }
  double more_points_percent = 0;  ///< its share less the first group's, in percentage points: what the table calls
                                   ///< relative change
  std::optional<double> relative_ratio;         ///< the same over the first group's share
  std::optional<double> fisher_p, corrected_p;  ///< against the first group
};

/// The same participants' results in two phases, each acceptable or not.
struct AcceptableChange {
  std::string from, to;
  std::size_t pairs_count = 0, gained = 0, lost = 0;  ///< participants with one result in both; of these, who changed
  std::optional<double> mcnemar_p, corrected_p;       ///< none where nobody changed
  std::size_t several = 0;  ///< participants with several results in a phase, who are left out
};

struct Study {
  StudyParams params;
  std::size_t rows_count = 0, participants_count = 0;
  std::vector<std::string> notes;
  std::vector<MeasureStudy> measures;
  std::vector<AcceptableRow> acceptable;
  std::vector<AcceptableChange> acceptable_changes;  ///< of each two phases
};

/// Throws Error 64 where a named column is not there; 65 naming line and column where a participant is no token, is in
/// two groups, or a cell of a named measure, attempt or count is no number. What is missing, too little or equal is
/// told in the notes and in TestResult::why_not.
Study evaluate(const Table& table, const StudyParams& params);

/// The study as a table for a person, as JSON, and its tests as CSV with a row for each test.
std::string study_text(const Study& study);
std::string study_json(const Study& study);
std::string study_csv(const Study& study);

}  // namespace trephine::study
