// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "grid/grid.h"

namespace trephine::mask {

/// The smallest box that holds every voxel inside (above 0), and how many these are. Empty, with its begin at the
/// lattice's end, where there is none.
struct InsideBox : grid::Box {
  std::size_t count = 0;
};
InsideBox inside_box(const grid::Field& field);

}  // namespace trephine::mask
