// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/rigid_fit.h"
#include "lesson/print_record.h"

namespace trephine::lesson {

/// How a case lies elsewhere (in a scan, before a tracker) by the marks of its print.
struct MarkFit {
  RigidMap map;            ///< from a place of the case to there
  std::size_t marks = 0;   ///< found, of those that were printed
  double residual_mm = 0;  ///< root mean square of the marks' distances
  std::size_t mirrored_marks = 0;
  double mirrored_residual_mm = 1e3;  ///< of the mirrored case, where as many marks or more fit so
  std::vector<Vec3> used_mm;          ///< of the case
  std::vector<Vec3> found_mm;         ///< where they were found, in the same order
  std::vector<std::size_t> places;    ///< which of the places that were given each is
  /// What the marks' scatter means at a place of the case (target_error_mm).
  double error_mm(Vec3 case_mm) const { return target_error_mm(used_mm, residual_mm, case_mm); }
};
constexpr std::size_t least_marks = 4;
/// How far two marks may be from their distance in the print, and one from where the others say it is.
struct MarkTolerance {
  double pair_mm = 0.8, mark_mm = 1.2;
};
/// The largest set of places that lie to each other as the marks do, whatever their order. `marks` is 0 where no three
/// do.
MarkFit match_marks(const std::vector<PrintMark>& marks, const std::vector<Vec3>& found,
                    const MarkTolerance& tolerance = {});

}  // namespace trephine::lesson
