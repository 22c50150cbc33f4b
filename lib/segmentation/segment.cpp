// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/segment.h"

#include "base/error.h"
#include "segmentation/coarse_segment.h"
#include "segmentation/finish.h"
#include "segmentation/threshold.h"

namespace trephine::segmentation {

grid::Field segment(const grid::HuVolume& volume, const SegmentMasks& masks, const SegmentParams& params,
                    Report& report, const Progress& progress) {
  check_thresholds(params.lower_hu, params.upper_hu);
  if (params.coarse_mm > 0) {
    if (masks.within || masks.without) throw Error(ExitCode::usage, "", "coarse_mm", "only without another anatomy");
    return segment_coarsely(volume, params, report, progress);
  }
  return found_and_finished(
      volume, {params.grow_mm, params.max_scan_edge_ratio},
      [&](const mask::HuView& hu) { return segment_threshold(hu, masks, params, report, progress); }, report, progress);
}

}  // namespace trephine::segmentation
