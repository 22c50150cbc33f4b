// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <utility>

#include "base/result.h"
#include "mask/hu_view.h"

namespace trephine::segmentation {

/// The last steps for the field of an anatomy, however it was found.
struct FinishParams {
  double grow_mm = 0;  ///< moves the surface outwards by this; the field is then in mm
  double max_scan_edge_ratio =
      1;  ///< largest share of the rim in the slices that may be the edge of the scanned field; 1: any
};

/// Throws Error 64 where the lower one is above the upper one.
void check_thresholds(double lower_hu, double upper_hu);

struct FinishResult {
  std::optional<double> grown_mm;  ///< where it was asked for
  mask::MaskSize size;
  std::optional<double> scan_edge_ratio;  ///< where it is asked for, or most of the rim is the edge of the scan
  template <class V>
  static void describe(V& v) {
    using P = FinishResult;
    v.number(&P::grown_mm, "grown_mm", "How far the surface was moved outwards.");
    v.all_of(&P::size);
    v.number(&P::scan_edge_ratio, "scan_edge_ratio", "Share of the rim that is the edge of the scanned field.");
  }
};

/// Runs `find` on the volume, moves the surface, and crops the field to its positive part and a margin of two voxels.
/// Throws Error 65 where a voxel is not finite; 80 where the mask is empty, fills the volume or lies in one slice, or
/// where more of its rim than allowed is the edge of the scan. A fault that names no parameter is attributed to
/// lower_hu and upper_hu.
Outcome<grid::Field, FinishResult> found_and_finished(const grid::HuVolume& volume, const FinishParams& params,
                                                      const std::function<grid::Field(const mask::HuView&)>& find,
                                                      const Progress& progress);

/// The same where `find` gives an outcome, whose result has a member `finished`.
template <class R, class Find>
Outcome<grid::Field, R> finished(const grid::HuVolume& volume, const FinishParams& params, const Find& find,
                                 const Progress& progress) {
  Outcome<grid::Field, R> made;
  auto end = found_and_finished(
      volume, params,
      [&](const mask::HuView& hu) {
        made = find(hu);
        return std::move(made.value);
      },
      progress);
  made.value = std::move(end.value);
  made.result.finished = end.result;
  made.warnings.insert(made.warnings.end(), end.warnings.begin(), end.warnings.end());
  return made;
}

}  // namespace trephine::segmentation
