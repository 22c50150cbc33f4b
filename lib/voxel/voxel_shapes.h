// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "voxel/haptic_volume.h"

namespace trephine::voxel {

/// What fills a voxel of encoding `occupancy`: `share` of 255 is of shape `number`, the rest of shape `rest`; 0: of
/// none.
struct VoxelShapes {
  std::uint8_t number = 0, share = 0, rest = 0;
};
/// Of a voxel of the lattice. It is read as HapticDecoder reads it, which gives the same occupancies, while another
/// thread drills too.
VoxelShapes shapes_of_voxel(const grid::Grid<std::int16_t>& voxels, int i, int j, int k);

}  // namespace trephine::voxel
