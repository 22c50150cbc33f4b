// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mask/bits.h"
#include "mask/coarse.h"

namespace trephine::mask {

/// `share`: of each cell of the coarse raster, the part (0 to 1) that belongs to something. Gives the voxels of
/// `lattice`, the raster that the cells were made of, where that part, interpolated linearly between cells, is above a
/// half.
BitMask above_half(const grid::Grid<float>& share, const CoarseRaster& c, const grid::Lattice& lattice);

}  // namespace trephine::mask
