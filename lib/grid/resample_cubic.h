// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"

namespace trephine::grid {

/// The grid at the voxels of another lattice with parallel axes, by cubic interpolation (Catmull-Rom), because linear
/// interpolation would flatten curved parts. Beyond its ends the values continue.
Field resampled_cubic(Field from, const Lattice& to, const Progress& progress = {});

}  // namespace trephine::grid
