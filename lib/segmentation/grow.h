// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "grid/grid.h"

namespace trephine::segmentation {

struct GrowRequest {
  std::array<int, 3> seed{0, 0, 0};  ///< a voxel of the volume
  double radius_mm = 10;             ///< nothing beyond this distance from the seed's centre
  double lower_hu = 226, upper_hu = 3071;
};

/// What hangs together with the seed by faces within the ball and the range of HU: 1 where it is, on the voxels of the
/// box around it. Throws Error 64 for a seed that is no voxel, a radius that is not 0 to 200 mm, or a lower end above
/// the upper one; 64 where the seed itself is not in the range.
grid::Mask grow_in_ball(const grid::HuVolume& volume, const GrowRequest& request);

}  // namespace trephine::segmentation
