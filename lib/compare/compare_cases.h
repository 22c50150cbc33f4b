// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "cases/load_case.h"
#include "metrics/deviation.h"

namespace trephine::compare {

/// What is different between two versions of a case. Positions are DICOM patient LPS, mm, of both; "old" is the first.

struct CompareParams {
  double max_deviation_mm = 0, max_point_mm = 0, max_volume_ratio = 0;
  metrics::DeviationParams deviation;
  template <class V>
  static void describe(V& v) {
    using P = CompareParams;
    v.number(&P::max_deviation_mm, "max_deviation_mm", Range{1e-6, 1000},
             "Refuse (80) where a surface lies further from its old one than this; 0: no limit.")
        .none_at_zero();
    v.number(&P::max_point_mm, "max_point_mm", Range{1e-6, 1000},
             "Refuse (80) where a landmark, target or burr hole moved further than this; 0: no limit.")
        .none_at_zero();
    v.number(&P::max_volume_ratio, "max_volume_ratio", Range{1e-9, 1000},
             "Refuse (80) where a volume changed by more than this share of the old one; 0: no limit.")
        .none_at_zero();
    v.all_of(&P::deviation);
  }
};

/// In which of the two cases something is.
enum class InCases { both, only_old, only_new };
const char* to_text(InCases in);

struct AnatomyChange {
  std::string name;
  InCases in = InCases::both;
  bool same_bytes = false;  ///< shown by the same bytes: nothing was measured, for nothing can differ
  /// Of the new surface to the old one, where both have one; bias is positive where the new one lies outside. A shape
  /// that is displayed from the haptic volume in one of the cases has the surface that is felt in both, where both have
  /// that shape in their haptic volumes.
  std::optional<metrics::Deviation> deviation;
  bool old_is_felt = false, new_is_felt = false;
  std::string not_measured;              ///< why there is no deviation; empty where there is one, or where same_bytes
  std::optional<double> old_ml, new_ml;  ///< of what the deviation was measured between
  /// The new volume less the old one; none where one is a mesh's and the other a haptic volume's.
  std::optional<double> change_ml() const;
  std::optional<std::uint64_t> old_triangles, new_triangles;
};

struct PointChange {
  enum class Kind { landmark, target, burr_hole } kind = Kind::landmark;
  std::string name;
  InCases in = InCases::both;
  std::optional<Vec3> old_mm, new_mm;
  std::optional<double> moved_mm;    ///< where it is in both
  std::optional<double> turned_deg;  ///< of a burr hole's axis
  double old_confidence = 0, new_confidence = 0;
};

/// A value that is another one, or is in one of the cases only.
struct ValueChange {
  std::string name;
  std::optional<ParameterValue> old_value, new_value;
};

struct CaseComparison {
  std::string old_token, new_token;
  bool identical = false;                ///< every byte that a reader sees
  bool same_input = false;               ///< made from the same scan
  std::vector<AnatomyChange> anatomies;  ///< in the old case's order, then those that are only in the new one
  std::vector<PointChange> points;       ///< all, moved or not
  std::vector<ValueChange> about;        ///< program, face policy, parts of the case, haptic raster, materials
  std::vector<ValueChange> figures;      ///< of the patient, the class among them, and of anatomies and burr holes
  std::vector<ValueChange> parameters;   ///< effective ones, by path
  std::vector<std::string> warnings;     ///< what must be known to read the figures
};

/// Compares two cases, which may hold different anatomies. Deterministic. Throws what measure_deviation and contour
/// throw, with the anatomy as the field; Cancelled.
CaseComparison compare_cases(const cases::LoadedCase& old_case, const cases::LoadedCase& new_case,
                             const CompareParams& params = {}, const Progress& progress = {});

/// What exceeds the limits, one line each; empty where nothing does. An anatomy or a point that is in one case only
/// exceeds every limit that would have judged it.
std::vector<std::string> beyond_limits(const CaseComparison& comparison, const CompareParams& params);

/// For a person, and as JSON: {"old", "new", "identical", "same_input", "anatomies", "points", "about", "figures",
/// "parameters", "warnings"}.
std::string comparison_text(const CaseComparison& comparison);
std::string comparison_json(const CaseComparison& comparison);

}  // namespace trephine::compare
