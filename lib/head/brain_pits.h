// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::head {

/// What noise alone has cut into the brain. `cut` is what is to be taken from `shape` (the brain with its sulci closed)
/// as sulci and cisterns. Each piece of it more than a millimetre deep is held against `hu` (levelled, not denoised):
/// it stays where tissue is darker there, summed over the piece, than `noise` (tissue_noise()) explains; where noise is
/// locally stronger, as in streaks, by so much more. Pieces that noise explains are returned.
mask::BitMask noise_pits(const mask::BitMask& cut, const mask::BitMask& shape, const grid::Grid<float>& hu,
                         const mask::BitMask& known, double noise, const Progress& progress = {});

}  // namespace trephine::head
