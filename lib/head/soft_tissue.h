// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "base/report.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::segmentation {

/// HU that brain tissue has after level_tissue: the middle of a well calibrated scan of a brain.
constexpr double tissue_level_hu = 30;

/// Scanners differ by several HU, and beam hardening darkens the middle of a head: fits a quadratic in space to the
/// brain's tissue among the voxels in `known` (robustly: CSF, blood and calcifications have no weight) and moves the
/// values, all of them, so that tissue lies at tissue_level_hu everywhere, by at most 30 HU. Adds "tissue_hu" (the fit
/// in its middle) and "tissue_slope_hu" (how much it varies over the voxels).
void level_tissue(Grid<float>& hu, const BitMask& known, Report& report, const Progress& progress = {});

/// Noise of tissue in the scan as HU mm^1.5: the square root of white noise's spectral density, so that a mean over a
/// volume of v mm^3 has a standard deviation of that by sqrt(v), whatever kernel and thickness. From the spread between
/// two Gaussian means in the tissue among `known`.
double tissue_noise(const Grid<float>& hu, const BitMask& known, const Progress& progress = {});
/// Throws Error 80 where that leaves so much in a cube of 2 mm (or a voxel, where that is larger) that CSF and tissue,
/// some 20 HU apart, are not told apart.
void check_noise(double noise, const Lattice& lattice);

/// Denoises within `domain`, in place: the result is argmin of 1/2 |u - hu|^2 + strength * (total variation of u),
/// lengths in mm [Rudin1992], found by the accelerated primal-dual method of [Chambolle2011]. Each threshold of the
/// result is the global optimum of region competition for that threshold, where a mm^2 of surface costs `strength`
/// [Chan2006]. Edges stay where they are, and structures smaller than 2 strength / contrast vanish. Values outside the
/// domain neither change nor have an effect.
void total_variation(Grid<float>& hu, const BitMask& domain, double strength_hu_mm, int iterations,
                     const Progress& progress = {});

/// What brain and ventricles are found in: levelled (where asked for) and denoised as strongly as its noise needs.
/// `known` are the voxels to go by; the others get the mean of known ones beside them, or `nowhere`.
Grid<float> soft_tissue(Grid<float> hu, const BitMask& known, bool level, double strength_ratio, float nowhere,
                        Report& report, const Progress& progress = {});

}  // namespace trephine::segmentation
