// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "mask/bits.h"
#include "mask/hu_view.h"

namespace trephine::segmentation {

/// A raster whose cells are whole boxes of voxels of another, the fine one; the last ones may reach beyond its end.
struct CoarseRaster {
  Lattice fine, cells;
  std::array<int, 3> factor{1, 1, 1};
};

/// Cells as near to `cell_mm` as whole voxels allow; at most that large where `at_most`, never larger than the lattice,
/// never smaller than a voxel.
CoarseRaster coarse_raster(const Lattice& fine, double cell_mm, bool at_most = false);

/// The cells that hold at least `share` of their voxels (0: any voxel) in the mask.
BitMask coarse_mask(const BitMask& fine, const CoarseRaster& raster, double share);

/// The mean HU of each cell's voxels among `known` (on raster.fine, which lies in the volume's raster); `nowhere` where
/// there are none.
Grid<float> coarse_mean(const HuView& hu, const BitMask& known, const CoarseRaster& raster, float nowhere);

/// The field on the fine voxels, linear between the cells' middles.
Field refined(const Field& cells, const CoarseRaster& raster);

}  // namespace trephine::segmentation
