// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A case laid on another scan of the same head by its bone.
#include <array>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "outcome/bone_points.h"

namespace trephine::outcome {

/// How well bone lies on bone.
struct BoneFit {
  itk::LinearMap map;  ///< from a place of the case to the scan
  /// Beside that all bone is wider by widening_mm: the root mean square of the nearest four fifths, each at most 2 mm.
  double residual_mm = 1e9, widening_mm = 0;
  double overlap_ratio = 0;  ///< of the points that lie within the scan
  double matched_ratio = 0;  ///< of those that have an edge of bone within 2 mm
  std::size_t points = 0;    ///< matched
  double scale_ratio = 0;    ///< by how much it would still stretch along one of the case's axes at most
};

/// Finds where the bone lies: many turns and shifts on a map of distances to the scan's bone, then along each point's
/// normal to the edge of bone in the scan between its voxels, outer and inner tables alike, and with one width by
/// which all bone is wider, so that another kernel, thickness of slices or edge of bone shifts nothing. What has no
/// edge nearby (new holes) does not count, and what is far off (metal, what was cut) counts less (Tukey's weights).
/// Nothing where too little of the bone lies in the scan for that. It begins with middle on middle, shifted along z by
/// each of `up_mm`. Cancelled.
std::optional<BoneFit> fit_bone(const std::vector<BonePoint>& points, const ScanView& scan,
                                const Progress& progress = {},
                                const std::vector<double>& up_mm = {0, 35, -35, 70, -70});

/// fit_bone() from a place that is nearly right.
BoneFit refined_fit(const std::vector<BonePoint>& points, const ScanView& scan, const itk::LinearMap& from);

/// The same points mirrored at a plane across x through their middle: what a mirrored scan would show.
std::vector<BonePoint> mirrored(std::vector<BonePoint> points);

/// The fit made again without each eighth of the head in turn.
class LeftOutFits {
 public:
  LeftOutFits(const std::vector<BonePoint>& points, const ScanView& scan, const BoneFit& all,
              const Progress& progress = {});
  /// The standard error of where a place of the case lies: the jackknife's estimate, from how far it moves.
  double standard_error_mm(Vec3 case_mm) const;

 private:
  itk::LinearMap all_;
  std::vector<itk::LinearMap> without_;
};

}  // namespace trephine::outcome
