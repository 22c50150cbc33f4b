// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <vector>

#include "base/params.h"
#include "base/rigid_fit.h"

namespace trephine::track {

/// Fewer say too little of a tip or an axis.
constexpr std::size_t least_poses = 40;

struct PivotParams {
  double least_spread_deg = 10, largest_pivot_mm = 1.5, largest_tip_error_mm = 0.5;
  template <class V>
  static void describe(V& v) {
    using P = PivotParams;
    v.number(&P::least_spread_deg, "least_spread_deg", Range{1, 45},
             "Refuse a tip about which the tool was turned less widely.");
    v.number(&P::largest_pivot_mm, "largest_pivot_mm", Range{0.01, 20},
             "Refuse a tip that was off its place by more, root mean square.");
    v.number(&P::largest_tip_error_mm, "largest_tip_error_mm", Range{0.01, 20},
             "Refuse a tip whose standard error is larger.");
  }
};

/// Where the tip of a tool is in the frame of its body.
struct PivotTip {
  Vec3 tip_mm;
  Vec3 rest_mm;  ///< where it rested
  double residual_mm = 0, tip_error_mm = 0;
  /// How widely the tool was turned about its tip: 0 where only about its axis. Of a full cone it is about 0.7 of what
  /// the axis was tilted.
  double spread_deg = 0;
  std::size_t used = 0, outliers = 0;
};

/// Of poses in which the tip rested in one place: the least squares of R t + p = r in both places, in one step
/// [Yaniv2015]; poses that lie far off (a slip) are left out. The error is found by leaving each eighth of the time
/// out. Throws Error 80 where the poses are too few or alike, the tip moved, or its error is too large.
PivotTip pivot_tip(const std::vector<RigidMap>& poses, const PivotParams& params);

/// The direction about which the tool was turned, unit, in the body's frame, from the tip to its tail: the side on
/// which the body lies. Throws Error 80 where it was not turned about one axis.
Vec3 spin_axis(const std::vector<RigidMap>& poses, Vec3 tip_mm);

}  // namespace trephine::track
