// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>

#include "surface/trimesh.h"

namespace trephine {

/// Grows the box to hold what is given. Nothing is included in empty bounds, so they are what they are given first.
inline void include(Bounds& all, const Bounds& more) {
  for (int a = 0; a < 3; ++a) {
    all.min_mm[a] = std::min(all.min_mm[a], more.min_mm[a]);
    all.max_mm[a] = std::max(all.max_mm[a], more.max_mm[a]);
  }
}
inline void include(Bounds& all, Vec3 point_mm) { include(all, Bounds{point_mm, point_mm}); }

}  // namespace trephine
