// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "session/playback.h"

namespace trephine::dataset {

/// When voxels were removed, or came back. A voxel is removed where its shape no longer fills half of it, which is when
/// the shape's surface has passed its middle.
struct VoxelEvents {
  struct Voxel {
    std::size_t step;       ///< of time_s
    std::array<int, 3> at;  ///< in the haptic volume
    int shape;              ///< its number
  };
  std::vector<double> time_s;  ///< of each 60th of a second in which there was one
  std::vector<Voxel> voxels;   ///< in the order of their times
};
enum class VoxelEvent { removed, restored };

VoxelEvents voxel_events(const voxel::HapticVolume& volume, const std::vector<session::Playback::VoxelChange>& changes,
                         VoxelEvent which);

}  // namespace trephine::dataset
