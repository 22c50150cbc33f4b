// SPDX-License-Identifier: GPL-3.0-or-later
#include "cast/cast_shapes.h"

#include "base/parallel.h"
#include "base/srgb.h"
#include "voxel/voxel_shapes.h"

namespace trephine::cast {

CastShapes::CastShapes(const voxel::HapticVolume& volume, const cases::CaseHaptic& haptic)
    : voxels_(grid::Lattice(volume.voxels)) {
  for (const cases::CaseShape& s : haptic.shapes) {
    CastTable::Entry& e = entries_[std::size_t(s.number)];
    for (std::size_t c = 0; c < 3; ++c) e[c] = float(linear_of_srgb(s.material.colour_rgb[c]));
    e[3] = 1;
  }
  follow(volume, grid::whole_box(volume.voxels));
}

grid::Box CastShapes::follow(const voxel::HapticVolume& volume, const grid::Box& changed) {
  const grid::Box box = grid::grown(changed, 1, voxels_);
  parallel_for(box.begin[2], box.end[2], 1, [&](std::int64_t begin, std::int64_t end) {
    for (int k = int(begin); k < int(end); ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for (int i = box.begin[0]; i < box.end[0]; ++i) {
          const voxel::VoxelShapes v = voxel::shapes_of_voxel(volume.voxels, i, j, k);
          voxels_.at(i, j, k) = {v.number, v.share, v.rest, 0};
        }
  });
  return box;
}

}  // namespace trephine::cast
