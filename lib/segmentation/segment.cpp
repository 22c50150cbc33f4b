// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/segment.h"

#include "base/error.h"
#include "segmentation/coarse_segment.h"
#include "segmentation/finish.h"
#include "segmentation/threshold.h"

namespace trephine::segmentation {

Outcome<grid::Field, SegmentResult> segment(const grid::HuVolume& volume, const SegmentMasks& masks,
                                            const SegmentParams& params, const Progress& progress) {
  check_thresholds(params.lower_hu, params.upper_hu);
  if (params.coarse_mm > 0) {
    if (masks.within || masks.without) throw Error(ExitCode::usage, "", "coarse_mm", "only without another anatomy");
    return segment_coarsely(volume, params, progress);
  }
  return finished<SegmentResult>(
      volume, {params.grow_mm, params.max_scan_edge_ratio},
      [&](const mask::HuView& hu) { return segment_threshold(hu, masks, params, progress); }, progress);
}

}  // namespace trephine::segmentation
