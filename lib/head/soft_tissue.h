// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "mask/bits.h"
#include "mask/scan_figures.h"

namespace trephine::head {

/// HU of brain tissue after level_tissue, which is the typical value in a well calibrated scan.
constexpr double tissue_level_hu = 30;

/// HU of the brain's tissue before level_tissue.
struct TissueLevel {
  double tissue_hu = 0;                   ///< the fit at its centre
  std::optional<double> tissue_slope_hu;  ///< how much it varies over the voxels; none: too few of them
  template <class V>
  static void describe(V& v) {
    using P = TissueLevel;
    v.number(&P::tissue_hu, "tissue_hu", Range{}, "HU of the brain's tissue.");
    v.number(&P::tissue_slope_hu, "tissue_slope_hu", "How much they vary.");
  }
};

/// Levels the brain's tissue. Scanners differ by several HU, and beam hardening darkens the middle of a head. A
/// quadratic in space is fitted robustly to the brain's tissue among the voxels in `known` (CSF, blood and
/// calcifications have no weight), and all values are moved by at most 30 HU, so that tissue lies at tissue_level_hu
/// everywhere.
TissueLevel level_tissue(grid::Grid<float>& hu, const mask::BitMask& known, const Progress& progress = {});

/// The noise of tissue in the scan as HU mm^1.5: the square root of the spectral density of white noise, so that a mean
/// over v mm^3 has a standard deviation of this value divided by sqrt(v), whatever the kernel and the slice thickness.
/// It is computed from the spread between two Gaussian means in the tissue among `known`.
double tissue_noise(const grid::Grid<float>& hu, const mask::BitMask& known, const Progress& progress = {});
/// Throws Error 80 where this noise leaves so much in a cube of 2 mm (or a voxel, where that is larger) that CSF and
/// tissue, some 20 HU apart, cannot be told apart. The noise is that of values which a Gaussian of sigma `smoothed_mm`
/// smoothed before (0: none did); the remedy says which sigma would do.
void check_noise(double noise, const grid::Lattice& lattice, double smoothed_mm);
/// The smallest sigma in tenths of a mm, above `smoothed_mm`, of a Gaussian against white noise after which
/// tissue_noise() would measure at most `wanted` where it measures `noise` after one of smoothed_mm; 1e9 where even 5
/// mm would not do.
double smoothing_for_noise(double noise, double smoothed_mm, double wanted);
/// The same of a scan as measure_scan sees it, whatever the colour of its noise: so much that the skull itself is found
/// wrong leaves tissue_noise() no tissue to measure. Nothing is checked where
/// measure_scan does not know the noise, and in voxels of more than 8 mm^3. `measured` gives what measure_scan says of
/// the volume; empty: it is asked here.
void check_scan_noise(const grid::HuVolume& volume,
                      const std::function<mask::ScanFigures(const Progress& progress)>& measured = {},
                      const Progress& progress = {});

/// The image in which brain and ventricles are found, and its noise as tissue_noise() measures it.
struct SoftTissue {
  grid::Grid<float> image;
  double noise_hu_mm1_5 = 0;
};

/// Denoises the image as strongly as its noise needs. Only the voxels in `known` count; the others get the mean of the
/// known ones beside them, or `nowhere`.
SoftTissue soft_tissue(grid::Grid<float> hu, const mask::BitMask& known, double strength_ratio, float nowhere,
                       const Progress& progress = {});

}  // namespace trephine::head
