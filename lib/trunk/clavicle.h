// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "mask/hu_view.h"

namespace trephine::trunk {

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
             "The patient's side; both: all that are found, at least one.");
    v.choice(&P::part, "part", {{"clavicle", ClaviclePart::clavicle}, {"rest", ClaviclePart::rest}},
             "The clavicles, or all other bone.");
    v.number(&P::core_mm, "core_mm", Range{0, 5},
             "Bridges to other bones thinner than twice this are ignored while a clavicle is searched for.");
    v.number(&P::min_length_mm, "min_length_mm", Range{20, 200},
             "Pieces that are shorter from side to side are not clavicles.");
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

/// The middle lines of the clavicles, the right one first; empty where nothing looks like one. `bone` is as below.
std::vector<ClavicleCourse> clavicle_courses(const grid::Field& bone, const ClavicleParams& params,
                                             const Progress& progress = {});

struct ClavicleFigures {
  double length_mm = 0, volume_ml = 0;
  double joint_mm2 = 0;  ///< area cut through bone
  template <class V>
  static void describe(V& v) {
    using P = ClavicleFigures;
    v.number(&P::length_mm, "length_mm", Range{}, "From end to end.");
    v.number(&P::volume_ml, "ml", Range{}, "Volume.");
    v.number(&P::joint_mm2, "joint_mm2", Range{}, "Area cut through bone at its joints.");
  }
};
struct ClaviclesResult {
  Named<ClavicleFigures> sides;  ///< "right" and "left", as far as found
  mask::MaskSize size;
  std::size_t cut_voxels_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = ClaviclesResult;
    v.map(&P::sides, "sides", "Each clavicle.").items_joined("_");
    v.all_of(&P::size);
    v.integer(&P::cut_voxels_count, "cut_voxels_count", Range{}, "Voxels where the shape is cut from other bone.");
  }
};

/// Separates the clavicles from the other bone of a chest or shoulders. `bone` is a filled field, positive inside, that
/// holds them among ribs, sternum and scapulae. In sagittal planes a clavicle is a round piece in front of all other
/// bone, in one plane after the other over at least min_length_mm. At its joints it is separated from other bone at the
/// narrowest place (a seeded watershed on the depth in the bone), and the cut is smoothed. Arms may be down or raised;
/// the patient may be tilted by at most about 30 degrees. A clavicle that the scan cuts is found as far as it goes.
///
/// Returns a field in bone's unit, positive inside, cropped as segment() does; with part rest, all other bone, and
/// nothing inside `without` (a vein so bright that it was taken for bone). Warns where a side was
/// not found, and where a clavicle is connected with other bone over more than max_joint_mm2: there no joint separates
/// it, and its end is merely where the bone is narrow.
///
/// The result has the same bits whatever the thread count. Throws Error 80 where the bone is empty, or no clavicle of
/// the requested side is found; Cancelled.
Outcome<grid::Field, ClaviclesResult> find_clavicles(const grid::Field& bone, const ClavicleParams& params,
                                                     const Progress& progress = {},
                                                     const grid::Field* without = nullptr);

}  // namespace trephine::trunk
