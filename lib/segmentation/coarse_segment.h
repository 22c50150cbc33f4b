// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "segmentation/segment.h"

namespace trephine::segmentation {

/// segment() without other anatomies, on cells of whole voxels of about params.coarse_mm, each as bright as its
/// brightest voxel. The field is on the volume's raster, in steps of a cell. Throws what segment() throws.
Outcome<grid::Field, SegmentResult> segment_coarsely(const grid::HuVolume& volume, const SegmentParams& params,
                                                     const Progress& progress = {});

}  // namespace trephine::segmentation
