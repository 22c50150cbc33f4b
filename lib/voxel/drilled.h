// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "grid/grid.h"
#include "voxel/haptic_volume.h"

namespace trephine::voxel {

/// How labels name what was removed of a shape: "skull_removed".
inline constexpr char removed_suffix[] = "_removed";

/// What other programs show of a voxel, whole or not at all: the shape that fills most of it, where all shapes together
/// fill at least half of it; else 0.
grid::Mask shown_shapes(const HapticVolume& volume);

/// The volume as it is when voxels were taken off whole, as another program drills: those that are not 0 in `removed`
/// (the same lattice) are EMPTY; so is what was left in voxels beside them that other programs do not show, less than
/// half of one, with nothing else beside it that stands. What other voxels hold beside what was removed is EMPTY, too.
/// Throws Error 70 where the lattices differ.
HapticVolume drilled_volume(const HapticVolume& volume, const grid::Mask& removed);

}  // namespace trephine::voxel
