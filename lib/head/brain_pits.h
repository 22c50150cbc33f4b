// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::head {

/// What noise alone has cut into the brain. `cut` is what is to be taken from `shape` (the brain with its sulci closed)
/// as sulci and cisterns. What of it lies more than a millimetre deep is held against `hu` (levelled, not denoised) and
/// its noise (`noise`, of tissue_noise(); locally stronger where streaks are): it remains where means along edges and
/// sulci, wide enough for that noise, are darker than tissue by 3 standard deviations, and 2 mm about such places;
/// of the rest, pieces that are as a whole darker by 9. All else of it is returned.
mask::BitMask noise_pits(const mask::BitMask& cut, const mask::BitMask& shape, const grid::Grid<float>& hu,
                         const mask::BitMask& known, double noise, const Progress& progress = {});

}  // namespace trephine::head
