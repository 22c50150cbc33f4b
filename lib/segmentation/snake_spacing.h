// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstddef>

#include "grid/grid.h"

namespace trephine::segmentation {

/// What the solver of a snake needs of a lattice at every voxel, worked out once: its sides in mm as floats, and how
/// far a neighbour along an axis lies in memory.
struct SnakeSpacing {
  explicit SnakeSpacing(const grid::Lattice& l) {
    for (int a = 0; a < 3; ++a) {
      h[a] = float(l.spacing_mm[a]);
      inv_h[a] = 1 / h[a];
      inv_h2[a] = inv_h[a] * inv_h[a];
    }
    finest = int(std::min_element(h, h + 3) - h);
    h_min = h[finest];
    h_max = std::max({h[0], h[1], h[2]});
    step[0] = 1;
    step[1] = l.size[0];
    step[2] = std::ptrdiff_t(l.size[0]) * l.size[1];
  }

  float h[3], inv_h[3], inv_h2[3];  ///< mm, and one over them and their squares
  float h_min = 0, h_max = 0;
  int finest = 0;  ///< the axis of h_min
  std::ptrdiff_t step[3];
};

}  // namespace trephine::segmentation
