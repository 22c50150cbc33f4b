// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The surfaces near a place as samples, for tools that are round and not points. Nothing here allocates or throws.
#include <algorithm>

#include "contact/felt_lattice.h"

namespace trephine::contact {

/// The square of the distance of p from the line (or point) between two places. samples_near() keeps a sample by it.
inline double squared_from_line(Vec3 p, Vec3 from, Vec3 to) {
  const Vec3 way = to - from;
  const double way_squared = dot(way, way);
  Vec3 d = p - from;
  if (way_squared > 0) d = d - way * std::clamp(dot(d, way) / way_squared, 0.0, 1.0);
  return dot(d, d);
}

/// What ContactVolume::samples_near gives.
int samples_near(const FeltLattice& felt, Vec3 from_mm, Vec3 to_mm, double reach_mm, SurfaceSample* out, int most);

}  // namespace trephine::contact
