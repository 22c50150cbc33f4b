// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "grid/grid.h"

namespace trephine::metrics {

/// The voxels of the mask that hold exactly `label` (as 1); label 0 stands for every value but 0.
grid::Mask select_label(const grid::Mask& labels, int label);

/// Volume of the voxels that are not 0.
double volume_mm3(const grid::Mask& mask);

/// Dice's coefficient 2 |a and b| / (|a| + |b|) of the voxels that are not 0 [Dice1945]: 1 where both masks are the
/// same, 0 where they have nothing in common, 1 where both are empty. The masks lie on one raster and each may cover
/// any part of it; what a mask does not cover counts as outside. Throws Error 65 where the rasters differ.
double dice(const grid::Mask& a, const grid::Mask& b);

}  // namespace trephine::metrics
