// SPDX-License-Identifier: GPL-3.0-or-later
// A volume that passes for a CT in HU and takes no time to write and read.
#pragma once
#include "grid/grid.h"

namespace trephine {

/// Every axis has its own size and spacing. `oblique`: the rows are turned by 37 degrees about z.
inline grid::Lattice small_lattice(bool oblique) {
  grid::Lattice l;
  l.size = {24, 20, 18};
  l.spacing_mm = {2.5, 3, 4};
  l.origin_mm = {-30, -41.5, 12.25};
  if (oblique) l.direction = {{Vec3{0.8, 0.6, 0}, Vec3{-0.6, 0.8, 0}, Vec3{0, 0, 1}}};
  return l;
}

/// Air, a ball of tissue, a shell of bone.
inline grid::Grid<std::int16_t> small_ct(bool oblique = true) {
  grid::Grid<std::int16_t> g(small_lattice(oblique));
  for (int k = 0; k < 18; ++k)
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 24; ++i) {
        const double r = norm(Vec3{i - 11.5, (j - 9.5) * 1.2, (k - 8.5) * 1.4});
        g.at(i, j, k) = static_cast<std::int16_t>(r > 11 ? -1000 + i % 7 : r > 9 ? 900 + j : 30 + k % 5);
      }
  return g;
}

}  // namespace trephine
