// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A scan of a printed head, laid on its case by the spheres of the print.
#include <vector>

#include "base/progress.h"
#include "itk/transform.h"
#include "outcome/bone_points.h"
#include "print/print_record.h"

namespace trephine::outcome {

/// A sphere that was found in a scan, LPS mm of the scan.
struct FoundSphere {
  Vec3 at_mm;
  double radius_mm = 0, rms_mm = 0;
  double share = 0;  ///< of the directions in which its surface was seen
};

/// Finds spheres of that radius whose outside is air, the best first: edges vote for middles (Hough), and each middle
/// is fitted to the half height of its own edge between the voxels, without what does not belong to it, such as a post.
std::vector<FoundSphere> find_spheres(const ScanView& scan, double radius_mm, const Progress& progress = {});

/// How a case lies in the scan by its marks.
struct MarkFit {
  itk::LinearMap map;      ///< from a place of the case to the scan
  std::size_t marks = 0;   ///< found, of those that were printed
  double residual_mm = 0;  ///< root mean square of the marks' distances
  std::size_t mirrored_marks = 0;
  double mirrored_residual_mm = 1e3;  ///< of the mirrored case, where as many marks or more fit so
  std::vector<Vec3> used_mm;          ///< of the case
  /// What the marks' scatter means at a place of the case [Fitzpatrick1998].
  double error_mm(Vec3 case_mm) const;
};
constexpr std::size_t least_marks = 4;
/// The largest set of spheres that lie to each other as the marks do. `marks` is 0 where no three do.
MarkFit fit_marks(const std::vector<print::PrintMark>& marks, const std::vector<FoundSphere>& spheres);

}  // namespace trephine::outcome
