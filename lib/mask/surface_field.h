// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::segmentation {

/// Turns `edge` (in HU, positive where a voxel is of the material: what places the surface) and the decided mask
/// `shape` (the same lattice) into a field, in place:
///  - its sign is the mask's everywhere, and no voxel is 0;
///  - where the mask ends with the material, the values beside the surface are the edge's own, so that the partial
///  volume
///    places it;
///  - where the mask cuts through material, or where a filled hole meets the outside, they follow the mask smoothed by
///  a
///    Gaussian of `cut_sigma_mm`, scaled to `scale_hu`, so that a cut is no staircase.
/// Returns how many voxels of the mask lie at such a cut.
std::size_t place_surface(Field& edge, const BitMask& shape, double cut_sigma_mm, double scale_hu,
                          const Progress& progress = {});

/// Moves the edge of bright material from the fixed threshold to the half maximum: hu is the volume minus `lower_hu`;
/// every voxel within reach_mm of the mask's surface gets instead hu minus the mean of the largest value uphill and the
/// smallest downhill along the gradient, within reach_mm and as long as the profile rises or falls; never below the
/// fixed threshold, nor is anything taken as brighter than brightest_hu (metal). Voxels from which the way downhill
/// does not leave the mask are inside, and keep theirs (diploe, filled cells). The mask loses the voxels that become
/// negative.
void apply_half_maximum(Field& hu, BitMask& shape, double lower_hu, double reach_mm, double brightest_hu,
                        const Progress& progress = {});

}  // namespace trephine::segmentation
