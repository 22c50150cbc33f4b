// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"
#include "place/place_head.h"

namespace trephine::head {

/// What in the lateral ventricles and the third is as dense as fresh blood (a clot, a level of blood, a plexus with
/// contrast medium). `soft` are HU, levelled (tissue at 30) and denoised; `envelope` is the brain with its sulci
/// closed, and `fluid` wide CSF in its depth. Pieces that are thinner than about 3 mm or smaller than 0.5 ml are left
/// out, and so are those of which less than half lies where the template has its ventricles (with more room at the
/// horns for what touches that CSF): they are blood in the brain. Empty where `place` is not sure.
mask::BitMask blood_in_ventricles(const grid::Grid<float>& soft, const mask::BitMask& envelope,
                                  const mask::BitMask& fluid, const place::HeadPlace& place,
                                  const Progress& progress = {});

/// Gives that blood, in place, the values that CSF would have there: its edge to the brain, halfway between both, stays
/// where it is, and the edge between blood and CSF goes. `hu` is levelled.
void show_blood_as_fluid(grid::Grid<float>& hu, const mask::BitMask& blood, const mask::BitMask& fluid,
                         const Progress& progress = {});

}  // namespace trephine::head
