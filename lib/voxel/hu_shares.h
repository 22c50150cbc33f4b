// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <optional>

#include "voxel/haptic_volume.h"

namespace trephine::voxel {

/// A shape of encoding `hu` as one value a voxel, 0 to 1, so that a surface that is drawn through 1/2 between voxel
/// centres lies where the shape is felt (haptic_volume.h), but beside a voxel of the shape that borders on lower HU and
/// on higher ones: there the surface towards the higher ones is wrong. Nothing allocates or throws; the volume must
/// outlive it, and its voxels may change meanwhile.
class HuShares {
 public:
  HuShares(const HapticVolume& volume, int number);
  /// Where the value alone says it; for a voxel of the shape its six neighbours say it.
  std::optional<double> of_value(int hu) const;
  double at(int i, int j, int k) const;

 private:
  double top_towards(int hu) const;
  const HapticVolume& volume_;
  HapticShape own_;
  std::array<int, haptic_max_shapes + 1> group_;
};

}  // namespace trephine::voxel
