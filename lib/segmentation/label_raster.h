// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <optional>

#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::segmentation {

/// How the label's axes lie along the volume's, where both are one raster.
struct RasterAlignment {
  std::array<int, 3> axis{};    ///< of the label, that runs along each of the volume's
  std::array<int, 3> sign{};    ///< and which way
  std::array<int, 3> offset{};  ///< the volume's index of the label's first voxel
  double off_voxels = 0;        ///< most that any of the label's voxels lies off the volume's
};

/// Nothing where the label's voxels lie more than 0.05 voxels off those of the volume's raster. Its axes may be flipped
/// or swapped, it may cover a part, or reach beyond.
std::optional<RasterAlignment> raster_alignment(const grid::Lattice& label, const grid::Lattice& volume);

/// The mask on the volume's voxels; what lies beyond them is lost.
mask::BitMask on_raster(const grid::Mask& label, const grid::Lattice& volume, const RasterAlignment& alignment);

}  // namespace trephine::segmentation
