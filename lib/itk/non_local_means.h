// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"

namespace trephine::itk {

struct NonLocalMeans {
  double search_mm = 3;  ///< radius of the ball in which patches are compared
  double patch_mm = 1;   ///< half of a patch's side
  double noise_hu = 30;  ///< standard deviation of the scan's noise
};

/// How many patches each voxel is compared with on such voxels.
std::size_t patches_compared(const grid::Lattice& lattice, const NonLocalMeans& params);

/// Non-local means [Buades2005]: each voxel becomes the mean of those whose surroundings look like its own. Patches are
/// compared whole, within a ball, without drawing lots: a difference (mean square, less twice the noise's variance)
/// of noise_hu squared weighs exp(-1), of which (1 - t / 8)^8 stands for exp(-t). Beyond its border the volume goes on
/// with the values of its border.
///
/// Memory: one further volume, padded, and about 25 MB a thread for slices of 512 x 512. The same bytes for every
/// number of threads.
grid::Grid<float> non_local_means(const grid::Grid<float>& grid, const NonLocalMeans& params,
                                  const Progress& progress = {});

}  // namespace trephine::itk
