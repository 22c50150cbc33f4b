// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A scan of a printed head, laid on its case by the spheres of the print.
#include <vector>

#include "base/progress.h"
#include "lesson/mark_fit.h"
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

using lesson::least_marks;
using lesson::MarkFit;
/// lesson::match_marks of the spheres' middles.
MarkFit fit_marks(const std::vector<print::PrintMark>& marks, const std::vector<FoundSphere>& spheres);

}  // namespace trephine::outcome
