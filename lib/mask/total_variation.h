// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::mask {

/// Denoises within `domain`, in place: the result is argmin of 1/2 |u - hu|^2 + strength * (total variation of u),
/// lengths in mm [Rudin1992], found by the accelerated primal-dual method of [Chambolle2011]. Each threshold of the
/// result is the global optimum of region competition for that threshold, where a mm^2 of surface costs `strength`
/// [Chan2006]. Edges stay where they are, and structures smaller than 2 strength / contrast vanish. Values outside the
/// domain neither change nor have an effect.
void total_variation(grid::Grid<float>& hu, const BitMask& domain, double strength_hu_mm, int iterations,
                     const Progress& progress = {});

}  // namespace trephine::mask
