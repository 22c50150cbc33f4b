// SPDX-License-Identifier: GPL-3.0-or-later
#include "consistency/accepted_places.h"

#include <algorithm>
#include <cmath>

namespace trephine::consistency {

bool is_accepted(Vec3 p, const std::vector<Vec3>& accepted_mm) {
  return std::any_of(accepted_mm.begin(), accepted_mm.end(),
                     [&](Vec3 place) { return norm(p - place) <= accepted_radius_mm; });
}

void accept(mask::BitMask& wrong, const std::vector<Vec3>& accepted_mm) {
  if (accepted_mm.empty()) return;
  const grid::Lattice& l = wrong.lattice();
  const grid::Box box = wrong.bounds();
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i)
        if (wrong.get(i, j, k) && is_accepted(l.to_world_mm({double(i), double(j), double(k)}), accepted_mm))
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
