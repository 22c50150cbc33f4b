// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mask/hu_view.h"
#include "segmentation/segment.h"

namespace trephine::segmentation {

/// The part of segment() that finds the shape. Its field is neither cropped nor checked yet.
Outcome<grid::Field, SegmentResult> segment_threshold(const mask::HuView& hu, const SegmentMasks& masks,
                                                      const SegmentParams& params, const Progress& progress);

}  // namespace trephine::segmentation
