// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::mask {

/// Averages each known voxel with the known voxels beside it in the plane of the edges and sheets around it: a Gaussian
/// of `sigma_mm` along the plane and hardly any smoothing across. A cleft of fluid 2 mm wide keeps its depth, while
/// noise falls as if it were averaged over 4 pi sigma^2. The plane is perpendicular to the principal direction of the
/// structure tensor [Weickert1998], which is made of gradients at a sigma of a millimetre or two thirds of sigma_mm,
/// whichever is larger, and averaged over twice that;
/// where there is no direction, any plane is taken. Voxels that are not known keep their value, and so do those that
/// are not in `where`, if it is given.
grid::Grid<float> averaged_along_sheets(const grid::Grid<float>& hu, const BitMask& known, double sigma_mm,
                                        const Progress& progress = {}, const BitMask* where = nullptr);

}  // namespace trephine::mask
