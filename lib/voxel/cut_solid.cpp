// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/cut_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "voxel/shape_occupancy.h"

namespace trephine::voxel::detail {

grid::Box box_of(const grid::Lattice& lattice, const surface::Bounds& bounds_mm, Vec3 margin_voxels) {
  const auto [low, high] = surface::index_bounds(lattice, bounds_mm);
  grid::Box box;
  for (int a = 0; a < 3; ++a) {
    if (!(bounds_mm.min_mm[a] <= bounds_mm.max_mm[a])) return {};
    const double size = lattice.size[std::size_t(a)];
    // Beyond what an int holds, and for NaN, the whole lattice is searched.
    const double begin = std::ceil(low[a] - margin_voxels[a]), end = std::floor(high[a] + margin_voxels[a]) + 1;
    box.begin[std::size_t(a)] = begin > 0 ? int(std::min(begin, size)) : 0;
    box.end[std::size_t(a)] = end < size ? int(std::max(end, 0.0)) : int(size);
  }
  return box;
}

SolidOnLattice::Sample SolidOnLattice::at(int i, int j, int k) const {
  const Vec3 world = lattice_.to_world_mm({double(i), double(j), double(k)});
  const double d = solid_(world), widest = largest_ramp_mm(lattice_);
  if (std::isnan(d)) return {std::numeric_limits<double>::infinity(), 0, 255};
  if (std::abs(d) >= widest) return {d, 0, d > 0 ? 255 : 0};
  const double step = 0.05 * std::min({lattice_.spacing_mm.x, lattice_.spacing_mm.y, lattice_.spacing_mm.z});
  Vec3 gradient;
  for (int a = 0; a < 3; ++a) {
    Vec3 before = world, after = world;
    before[a] -= step;
    after[a] += step;
    gradient[a] = solid_(after) - solid_(before);
  }
  const double length = norm(gradient);
  // On a medial axis no direction is defined, and every ramp is as good.
  const double ramp = length > 0 && std::isfinite(length) ? ramp_mm(lattice_, gradient / length) : widest;
  return {d, ramp, 255 - share_at(d, ramp)};
}

}  // namespace trephine::voxel::detail
