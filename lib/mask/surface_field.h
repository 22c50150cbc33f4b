// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::mask {

/// Turns `edge` and the mask `shape` (on the same lattice) into a field, in place. `edge` is in HU and positive where a
/// voxel is of the material.
/// - The field's sign is the mask's everywhere, and no voxel is 0.
/// - Where the mask ends with the material, the values beside the surface are those of `edge`, so that the partial
///   volume places the surface.
/// - Where the mask cuts through material, or where a filled hole meets the outside, the values follow the mask
///   smoothed by a Gaussian of `cut_sigma_mm` and scaled to `scale_hu`, so that a cut is not a staircase.
///
/// Returns how many voxels of the mask lie at such a cut.
std::size_t place_surface(grid::Field& edge, const BitMask& shape, double cut_sigma_mm, double scale_hu,
                          const Progress& progress = {});

/// Moves the edge of bright material from the fixed threshold to the half maximum. `hu` is the volume minus `lower_hu`.
/// Every voxel within reach_mm of the mask's surface gets hu minus the mean of the largest value uphill and the
/// smallest value downhill along the gradient; both are searched within reach_mm and as long as the profile rises or
/// falls. The edge is never below the fixed threshold, and nothing counts as brighter than brightest_hu (metal). Voxels
/// from which the path downhill does not leave the mask lie inside and keep their value (diploe, filled cells). The
/// mask loses the voxels that become negative.
void apply_half_maximum(grid::Field& hu, BitMask& shape, double lower_hu, double reach_mm, double brightest_hu,
                        const Progress& progress = {});

/// The voxels that are on the other side of the field's contour than of the field: in enclosed cavities, with what lies
/// in them, and in pieces below min_component_mm3 beside the largest one. By voxel; empty where there is none.
std::vector<bool> turned_by_contour(const grid::Field& field, double min_component_mm3, const Progress& progress = {});

}  // namespace trephine::mask
