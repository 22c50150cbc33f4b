// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"
#include "place/place_head.h"

namespace trephine::head {

/// Where blood is looked for, all on one lattice.
struct BloodPlace {
  const mask::BitMask& envelope;  ///< the brain with its sulci closed
  const mask::BitMask& known;     ///< where values count
  const mask::BitMask& wide;      ///< wide CSF in the brain's depth
  double csf_from_hu, csf_to_hu;
};

/// What in the lateral ventricles and the third is as dense as fresh blood (a clot, a level of blood, a plexus with
/// contrast medium) gets in `hu` the values that CSF would have there: its edge to the brain, halfway between both,
/// stays where it is, and the edge between blood and CSF goes. `hu` is levelled (tissue at 30), `soft` the same
/// denoised. Pieces that are thinner than about 3 mm or smaller than 0.5 ml are left out, and so are those of which
/// less than half lies where the template has its ventricles (with more room at the horns for what touches wide CSF):
/// they are blood in the brain. Nothing is done where `place` is not sure. Returns its volume in ml.
double show_blood_as_fluid(grid::Grid<float>& hu, const grid::Grid<float>& soft, const BloodPlace& where,
                           const place::HeadPlace& place, const Progress& progress = {});

}  // namespace trephine::head
