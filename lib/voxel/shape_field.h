// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>

#include "base/progress.h"
#include "voxel/haptic_volume.h"

namespace trephine::voxel {

/// A cylinder that something must pass: from position - above * direction to position + depth * direction.
struct Bore {
  Vec3 position_mm, direction;  ///< direction: unit
  double radius_mm = 0, above_mm = 0, depth_mm = 0;
};

/// How much thinner than the hole the object is that must pass it.
constexpr double hole_play_mm = 0.5;

/// Whether nothing of the shape is felt within the bore, less the play on all sides. The volume must have the shape.
bool hole_is_free(const HapticVolume& volume, const std::string& shape, const Bore& bore);

/// What the volume has of each shape, by number; shape_volume_mm3 (cut.h) is of one alone.
std::array<double, haptic_max_shapes + 1> shape_volumes_mm3(const HapticVolume& volume);

/// A shape's trilinear occupancy minus 1/2, on the volume's voxels: its contour at 0 is the felt surface.
grid::Field shape_field(const HapticVolume& volume, int number, const Progress& progress = {});

}  // namespace trephine::voxel
