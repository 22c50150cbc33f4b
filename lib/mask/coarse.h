// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "mask/bits.h"
#include "mask/hu_view.h"

namespace trephine::mask {

/// A raster whose cells are whole boxes of voxels of another, the fine raster. The last cells may reach beyond its end.
struct CoarseRaster {
  grid::Lattice fine, cells;
  std::array<int, 3> factor{1, 1, 1};
};

/// Chooses cells as near to `cell_mm` as whole voxels allow. With `at_most` they are not larger than that; they are
/// never larger than the lattice or smaller than a voxel.
CoarseRaster coarse_raster(const grid::Lattice& fine, double cell_mm, bool at_most = false);

/// Cells of these many voxels, each from 1 to the lattice's size.
CoarseRaster coarse_raster(const grid::Lattice& fine, const std::array<int, 3>& factor);

/// The cells of which at least `share` of the voxels are in the mask (0: any voxel).
BitMask coarse_mask(const BitMask& fine, const CoarseRaster& raster, double share);

/// The voxels of the cells that are set.
BitMask fine_mask(const BitMask& cells, const CoarseRaster& raster);

/// The mean HU of each cell's voxels in `known` (on raster.fine, which lies in the volume's raster); `nowhere` where
/// there are none.
grid::Grid<float> coarse_mean(const HuView& hu, const BitMask& known, const CoarseRaster& raster, float nowhere);

/// The mean of all values in each cell. The field lies on raster.fine.
grid::Field coarse_mean(const grid::Field& field, const CoarseRaster& raster);

/// The field on the fine voxels, interpolated linearly between the cells' centres.
grid::Field refined(const grid::Field& cells, const CoarseRaster& raster);

}  // namespace trephine::mask
