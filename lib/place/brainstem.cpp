// SPDX-License-Identifier: GPL-3.0-or-later
#include "place/brainstem.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mask/filters.h"

namespace trephine::place {
namespace {

constexpr Vec3 midbrain{0, 6, 30}, pons_end{0, 16, 4};
// Levels of the template at which a cavity is as wide as a foramen magnum, and how far to both sides, before and behind
// its middle it is looked for.
constexpr double first_z = -28, last_z = -20, level_mm = 2, reach_mm = 30;
constexpr double foramen_mm2[2] = {250, 1300}, most_beside_mm = 15;

double capsule_mm(Vec3 p, Vec3 a, Vec3 b, double radius_a, double radius_b) {
  const Vec3 ab = b - a;
  const double t = std::clamp(dot(p - a, ab) / dot(ab, ab), 0.0, 1.0);
  return norm(p - (a + ab * t)) - (radius_a + t * (radius_b - radius_a));
}

}  // namespace

double brainstem_mm(Vec3 p, Vec3 medulla_end) {
  return std::min(capsule_mm(p, midbrain, pons_end, 11.5, 12), capsule_mm(p, pons_end, medulla_end, 9, 6));
}

double beside_mm(Vec3 end, const HeadPlace& place) {
  return std::hypot((end.x - template_medulla_end.x) * place.scale.x, (end.y - template_medulla_end.y) * place.scale.y);
}

std::optional<Vec3> find_medulla_end(const mask::BitMask& cavity, const HeadPlace& place) {
  const double unit_mm2 = place.scale.x * place.scale.y;
  const grid::Lattice& l = cavity.lattice();
  std::vector<float> x,
      y;  // of all that is cavity at levels that are foramen; medians, for jugular foramina lie beside
  for (double z = first_z; z <= last_z; z += level_mm) {
    const std::size_t before = x.size();
    bool scanned = true;  // where the scan's end cuts a section, its middle is nobody's
    for (double side = -reach_mm; side <= reach_mm; ++side)
      for (double back = -reach_mm; back <= reach_mm; ++back) {
        const Vec3 t{template_medulla_end.x + side, template_medulla_end.y + back, z}, at = l.to_index(place.to_lps(t));
        const int i = int(std::lround(at.x)), j = int(std::lround(at.y)), k = int(std::lround(at.z));
        scanned = scanned && l.contains(i, j, k);
        if (!cavity.at(i, j, k)) continue;
        x.push_back(float(t.x));
        y.push_back(float(t.y));
      }
    const double mm2 = double(x.size() - before) * unit_mm2;
    if (scanned && mm2 > foramen_mm2[0] && mm2 < foramen_mm2[1]) continue;
    x.resize(before);
    y.resize(before);
  }
  if (x.empty()) return {};
  const Vec3 end{mask::median(x, 0), mask::median(y, 0), template_medulla_end.z};
  if (beside_mm(end, place) > most_beside_mm) return {};
  return end;
}

}  // namespace trephine::place
