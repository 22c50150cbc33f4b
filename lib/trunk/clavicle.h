// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "grid/grid.h"

namespace trephine {

enum class BodySide { both, left, right };
enum class ClaviclePart { clavicle, rest };

struct ClavicleParams {
  BodySide side = BodySide::both;
  ClaviclePart part = ClaviclePart::clavicle;
  double core_mm = 1;
  double min_length_mm = 70;
  double max_joint_mm2 = 150;

  template <class V>
  static void describe(V& v) {
    using P = ClavicleParams;
    v.choice(&P::side, "side", {{"both", BodySide::both}, {"left", BodySide::left}, {"right", BodySide::right}},
             "The patient's side; both: as many as are found, one at least.");
    v.choice(&P::part, "part", {{"clavicle", ClaviclePart::clavicle}, {"rest", ClaviclePart::rest}},
             "The clavicles, or all bone that is none.");
    v.number(&P::core_mm, "core_mm", Range{0, 5},
             "Bridges to other bones thinner than twice this do not count while a clavicle is looked for.");
    v.number(&P::min_length_mm, "min_length_mm", Range{20, 200}, "Shorter pieces from side to side are no clavicle.");
    v.number(&P::max_joint_mm2, "max_joint_mm2", Range{0, 2000},
             "Warn where a clavicle had to be cut from other bone over more than this.");
  }
};

/// The middle line of a clavicle, from its sternal end to its end at the shoulder.
struct ClavicleCourse {
  BodySide side = BodySide::left;
  std::vector<Vec3> points_mm;    ///< about a voxel apart, LPS
  std::vector<double> radius_mm;  ///< of a circle with the cross-section's area
};

/// The clavicles' middle lines, the right one first; none where nothing looks like one. `bone` as below.
std::vector<ClavicleCourse> clavicle_courses(const Field& bone, const ClavicleParams& params,
                                             const Progress& progress = {});

/// The clavicles out of the bone of a chest or shoulders (a filled field, positive inside) that holds them among ribs,
/// sternum and scapulae: in sagittal planes a clavicle is a round piece in front of all other bone, in one plane after
/// the other over at least min_length_mm. At its joints it is parted from other bone at the narrowest place (watershed
/// on the depth in the bone), and the cut is smoothed. Arms down or raised; for a patient who lies straight to about 30
/// degrees. A clavicle that the scan cuts is found as far as it goes.
///
/// Returns a field in bone's unit, positive inside, cropped as segment() does; part rest: all of bone but them, and
/// nothing inside `without` (a vein so bright that it was taken for bone).
/// Report: right_length_mm, right_ml, right_joint_mm2 (cut through bone) and the same of left, as far as found;
/// volume_ml. Warns of a side that was not found, and of one that hangs on other bone over more than max_joint_mm2:
/// there it was not parted by a joint, and its end is where the bone happens to be narrow.
///
/// The same bits whatever the thread count. Throws Error 80 where the bone is empty, or no clavicle of the side asked
/// for is found; Cancelled.
Field find_clavicles(const Field& bone, const ClavicleParams& params, Report& report, const Progress& progress = {},
                     const Field* without = nullptr);

}  // namespace trephine
