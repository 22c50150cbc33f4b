// SPDX-License-Identifier: GPL-3.0-or-later
#include "consistency/accepted_places.h"

#include <algorithm>
#include <cmath>

namespace trephine::consistency {

bool is_accepted(Vec3 p, const NotCompared& where) {
  if (where.field_edge) {
    const grid::Lattice& l = where.field_edge->lattice();
    const Vec3 at = l.to_index(p);  // a surface may lie half a voxel beyond the volume
    const auto near = [&](int a) { return at[a] > -1 && at[a] < l.size[std::size_t(a)]; };
    const auto voxel = [&](int a) { return std::clamp(int(std::lround(at[a])), 0, l.size[std::size_t(a)] - 1); };
    if (near(0) && near(1) && near(2) && where.field_edge->get(voxel(0), voxel(1), voxel(2))) return true;
  }
  return std::any_of(where.accepted_mm.begin(), where.accepted_mm.end(),
                     [&](Vec3 place) { return norm(p - place) <= accepted_radius_mm; });
}

void accept(mask::BitMask& wrong, const NotCompared& where) {
  if (!where.any()) return;
  const grid::Lattice& l = wrong.lattice();
  const grid::Box box = wrong.bounds();
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i)
        if (wrong.get(i, j, k) && is_accepted(l.to_world_mm({double(i), double(j), double(k)}), where))
          wrong.clear(i, j, k);
}

std::vector<Vec3> points_of(const mask::BitMask& mask) {
  std::vector<Vec3> points;
  const grid::Box box = mask.bounds();
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i)
        if (mask.get(i, j, k)) points.push_back(mask.lattice().to_world_mm({double(i), double(j), double(k)}));
  return points;
}

std::vector<Vec3> covering(std::vector<Vec3> points, Vec3 worst) {
  std::vector<Vec3> places;
  for (Vec3 next = worst; !points.empty(); next = points.front()) {
    if (places.size() == max_places_count) return {};
    places.push_back({std::round(next.x), std::round(next.y), std::round(next.z)});
    const double sure_mm = accepted_radius_mm - 1;
    points.erase(
        std::remove_if(points.begin(), points.end(), [&](Vec3 p) { return norm(p - places.back()) <= sure_mm; }),
        points.end());
  }
  return places;
}

}  // namespace trephine::consistency
