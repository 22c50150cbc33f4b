// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::segmentation {

/// The temporal and occipital horns where noise parts them from the rest: dark tubes of 1 to 4 mm radius that go on
/// from `shape` (the ventricles found), traced as cheapest paths through `hu` (levelled, not denoised; the `known`
/// voxels of it) deep in the brain's `envelope`, clear of `others` (CSF that is not ventricle), where an adult's horns
/// are about the brain's centre, at most 52 mm long each. What is broad (oedema, old defects) is no darker than what is
/// beside it and no tube; a path ends where the evidence for it has dropped from its best. All masks on the lattice of
/// `hu`; `noise` as tissue_noise() gives it. Returns the signed distance in mm to the tubes, positive inside, -4 far
/// off; their number in `count`.
Grid<float> find_horns(const Grid<float>& hu, const BitMask& known, const BitMask& envelope, const BitMask& others,
                       const BitMask& shape, Vec3 centre_mm, double noise, int& count, const Progress& progress = {});

}  // namespace trephine::segmentation
