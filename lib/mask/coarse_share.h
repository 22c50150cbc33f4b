// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mask/bits.h"
#include "mask/coarse.h"

namespace trephine::mask {

/// The voxels of `lattice` where the coarse share, interpolated linearly, is above a half.
BitMask above_half(const grid::Grid<float>& share, const CoarseRaster& c, const grid::Lattice& lattice);

}  // namespace trephine::mask
