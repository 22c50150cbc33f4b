// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/voxel_shapes.h"

#include "voxel/raw_voxel.h"

namespace trephine::voxel {

VoxelShapes shapes_of_voxel(const grid::Grid<std::int16_t>& voxels, int i, int j, int k) {
  const detail::RawVoxel v = detail::split(detail::load_voxel(voxels.voxels[voxels.index(i, j, k)]));
  const bool whole = v.number == 0 || v.bare || v.share == haptic_full;
  return {std::uint8_t(v.number), std::uint8_t(v.share),
          std::uint8_t(whole ? 0 : detail::other_shape(voxels, v.number, i, j, k))};
}

}  // namespace trephine::voxel
