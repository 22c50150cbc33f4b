// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>

#include "grid/grid.h"

namespace trephine::mask {

/// Calls f(i, j, k, distance from the centre in mm) for the lattice's voxels within `reach_mm` of the centre along each
/// axis, until f returns true.
template <class F>
void for_box_about(const grid::Lattice& l, Vec3 centre_mm, double reach_mm, F&& f) {
  const Vec3 c = l.to_index(centre_mm);
  int low[3], high[3];
  for (int a = 0; a < 3; ++a) {
    const double reach = reach_mm / l.spacing_mm[a];
    low[a] = int(std::clamp(std::ceil(c[a] - reach), 0.0, double(l.size[a])));
    high[a] = int(std::clamp(std::floor(c[a] + reach) + 1, 0.0, double(l.size[a])));
  }
  for (int k = low[2]; k < high[2]; ++k)
    for (int j = low[1]; j < high[1]; ++j)
      for (int i = low[0]; i < high[0]; ++i) {
        const Vec3 d{(i - c.x) * l.spacing_mm.x, (j - c.y) * l.spacing_mm.y, (k - c.z) * l.spacing_mm.z};
        if (f(i, j, k, norm(d))) return;
      }
}

}  // namespace trephine::mask
