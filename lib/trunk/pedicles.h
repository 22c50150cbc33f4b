// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"

namespace trephine::trunk {

struct PediclesParams {
  double depth_ratio = 0.75;
  double min_half_width_mm = 1.5;
  double min_height_mm = 5;

  template <class V>
  static void describe(V& v) {
    using P = PediclesParams;
    v.number(&P::depth_ratio, "depth_ratio", Range{0.3, 0.95},
             "Where the target lies on the way from the entry to where the axis would leave the body in front.");
    v.number(&P::min_half_width_mm, "min_half_width_mm", Range{0, 10},
             "A pedicle through which less clearance leads is doubtful: what is found may be none.");
    v.number(&P::min_height_mm, "min_height_mm", Range{2, 20},
             "Bone beside the canal that is lower than this is no pedicle.");
  }
};

/// The axis of a pedicle. LPS, mm.
struct PedicleAxis {
  int vertebra = 1;          ///< counted from the lowest that is seen; it is no level's name
  bool left = false;         ///< the patient's
  Vec3 entry_mm, target_mm;  ///< where the axis meets the bone behind, and in the body
  Vec3 middle_mm;            ///< where the pedicle is narrowest
  double half_width_mm = 0;  ///< the least distance from the axis to the pedicle's wall
  double confidence = 0;     ///< 0 to 1; below 0.5 it is doubtful, and `doubt` says why
  std::string doubt;
};

/// None where none was found and a person gives some.
struct PediclesFound {
  std::optional<std::int64_t> vertebrae_count, pedicles_count;
  template <class V>
  static void describe(V& v) {
    v.integer(&PediclesFound::vertebrae_count, "vertebrae_count", "Vertebrae with a pedicle.");
    v.integer(&PediclesFound::pedicles_count, "pedicles_count", "Pedicles that were found.");
  }
};

/// The pedicles of the vertebrae beside a canal: `bone` is the filled bone, `canal` what find_canal gives, both
/// positive inside, on one raster in axial slices.
///
/// - A pedicle is bone that begins within 4 mm of the canal's side, a third of the canal's depth behind its front, over
///   at least min_height_mm; foramina part one from the next.
/// - Its axis is the line that keeps the largest clearance from the wall of the bone over 12 mm about the narrowest
///   place. Of lines with the same clearance to 0.3 mm, as a pedicle higher than wide has, it is the one nearest to the
///   line through the middles of the cross-sections.
/// - The entry is where that line, followed backwards, leaves the bone; the target lies depth_ratio of the way to where
///   it leaves the body in front.
///
/// What it may fail to do: a pedicle that the scan's edge cuts is left out, with a warning; one that is fused with a
/// rib, a graft or the next level is doubtful; with a joint close behind, the entry lies in the joint, and is doubtful.
/// It counts vertebrae from below and names no level. Where levels lie nearer to each other than a spine's, as in
/// slices whose distance is wrong, all are doubtful, with a warning. Confidence: half-width, how closed the narrowest
/// cross-section is, whether the axis leans as a pedicle's does (docs/reference/lesson-spine.md), its length, how well
/// left and right mirror each other, also in width, and whether it rises as the others do.
///
/// The same bits whatever the thread
/// count. Throws Error 65 where the rasters differ; 80 where no pedicle is found and, before any axis is looked
/// for, where all bone beside the canal is so high that each confidence would be 0, but not with `some_given`, for a
/// person may give what is not found; Cancelled.
Outcome<std::vector<PedicleAxis>, PediclesFound> find_pedicles(const grid::Field& bone, const grid::Field& canal,
                                                               const PediclesParams& params,
                                                               const Progress& progress = {}, bool some_given = false);

/// How much bone is about the line from entry to target in its narrowest place within the middle half: the half-width
/// of an axis that a person gave. Negative where the line leaves the bone there.
double clearance_along(const grid::Field& bone, Vec3 entry_mm, Vec3 target_mm);

}  // namespace trephine::trunk
