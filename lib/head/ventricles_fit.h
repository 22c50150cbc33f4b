// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::head {

/// Places the surface of a body of fluid in brighter tissue by fitting a model of the image to `hu`, all on the lattice
/// of `hu`: what the scanner would show of the shape (its edges blurred in the slice, averaged over the slice's
/// thickness, fluid of one HU, tissue as it is beside) is compared with what it did show, and the surface moved by what
/// explains the difference best: about each place a common way outwards and a common shift, weighted least squares
/// under a Gaussian as wide as `noise` (tissue_noise()) asks for. Since the right shape leaves nothing but noise, thin
/// parts are neither shrunk nor widened, slices as thick as a horn or not.
///
/// `start` is the signed distance to a first surface, mm, positive inside, right in topology and to about 2 mm; only
/// voxels in `known` are gone by (no bone, no other fluid). In `necks` (may be null) no smoothing closes a passage or
/// opens a wall that `start` has, which costs smoothness where there is much noise. Returns the signed distance.
grid::Field fit_fluid(const grid::Grid<float>& hu, const mask::BitMask& known, const grid::Field& start, double noise,
                      const mask::BitMask* necks = nullptr, const Progress& progress = {});

}  // namespace trephine::head
