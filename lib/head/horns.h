// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"
#include "place/place_head.h"

namespace trephine::head {

/// Finds the temporal and occipital horns where noise separates them from the rest: dark tubes of 1 to 4 mm radius that
/// continue `shape` (the ventricles found so far). They are traced as cheapest paths through `hu` (levelled, not
/// denoised; only its `known` voxels), deep in the brain's `envelope`, away from `others` (CSF that is not ventricle),
/// near the template's horns (where `place` is not sure: where an adult's horns lie relative to the brain's
/// centre), at most 52 mm long each. Broad regions (oedema, old
/// defects) are no darker than their surroundings and make no tube. A path ends where the evidence for it has dropped
/// from its best. All masks are on the lattice of `hu`; `noise` is the result of tissue_noise(). Returns the signed
/// distance in mm to the tubes (positive inside, -4 far off), and their number in `count`.
grid::Grid<float> find_horns(const grid::Grid<float>& hu, const mask::BitMask& known, const mask::BitMask& envelope,
                             const mask::BitMask& others, const mask::BitMask& shape, Vec3 centre_mm,
                             const place::HeadPlace& place, double noise, int& count, const Progress& progress = {});

}  // namespace trephine::head
