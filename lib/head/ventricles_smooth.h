// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::head {

/// Distances that the fit of the ventricles works with end here, mm to either side of the surface.
constexpr double fit_far_mm = 8;

/// Smooths the surface of a signed distance (mm, positive inside) as far as the shape's thickness allows; twice the
/// Gaussian mean less the mean of that, which leaves what is curved evenly where it is. Distances beyond fit_far_mm
/// become that. On `necks` (may be null), of as many slices or fewer, what smoothing would move far stays: no passage
/// closes, no wall opens.
void smooth_fit(grid::Grid<float>& distance, const mask::BitMask* necks, const Progress& progress);

}  // namespace trephine::head
