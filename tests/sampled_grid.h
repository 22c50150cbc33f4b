// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "grid/grid.h"

namespace trephine {

/// f(world position in mm) at every voxel's centre.
template <class F>
grid::Grid<float> sampled(const grid::Lattice& l, F&& f) {
  grid::Grid<float> g(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) g.at(i, j, k) = float(f(l.to_world_mm({double(i), double(j), double(k)})));
  return g;
}

}  // namespace trephine
