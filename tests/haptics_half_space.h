// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>

#include "haptics_tools.h"

namespace trephine::tools {

/// Solid behind a plane through the origin, as voxelize makes it.
inline voxel::HapticVolume half_space(Vec3 normal) {
  voxel::HapticVolume v = empty(56, {0.5, 0.5, 0.5});
  const double ramp = 0.5 * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
  for (int k = 0; k < 56; ++k)
    for (int j = 0; j < 56; ++j)
      for (int i = 0; i < 56; ++i) {
        const double d = dot(normal, v.voxels.to_world_mm({double(i), double(j), double(k)}));
        const int o = int(std::lround(255 * std::clamp(0.5 - d / (2 * ramp), 0.0, 1.0)));
        if (o > 0) v.voxels.at(i, j, k) = std::int16_t(1000 + o + (o < 255 ? 300 : 0));
      }
  v.shapes = {voxel::occupancy_shape("bone", 1)};
  return v;
}

}  // namespace trephine::tools
