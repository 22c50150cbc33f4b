// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"

namespace trephine::segmentation {

/// The mean of `hu` along the level sets of `distance` (signed, mm, the same lattice), for every voxel within reach_mm
/// of 0: over a patch about it with Gaussian weights of sigma_mm, each of its points moved along the gradient onto the
/// voxel's own level. Noise falls with the patch's area, and an edge that runs along the level sets is neither blurred
/// nor moved, however curved. Points whose level set turns away are left out. Elsewhere the values are hu's.
Grid<float> averaged_along(const Grid<float>& hu, const Grid<float>& distance, double reach_mm, double sigma_mm,
                           const Progress& progress = {});

}  // namespace trephine::segmentation
