// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "trunk/pedicle_parts.h"

namespace trephine::trunk {
namespace {

constexpr double step_mm = 0.5;        // along rays and in height
constexpr double behind_front = 0.35;  // share of the canal's depth at which its sides are looked at
constexpr double max_gap_mm = 4;       // from the canal's side to the bone
constexpr double min_chord_mm = 2.5, max_chord_mm = 14;
constexpr double max_hole_mm = 1.6;  // of height, without bone: a vessel or noise

// The canal in a slice, in world coordinates.
struct Level {
  double z = 0, x = 0, y = 0;  ///< where its sides are looked at: the middle, and that share behind its front
  bool known = false;
};

std::vector<Level> levels_of(const grid::Field& canal) {
  std::vector<Level> all;
  for (int k = 0; k < canal.size[2]; ++k) {
    Level level;
    double sum_x = 0, count = 0, front = 1e9, back = -1e9;
    for (int j = 0; j < canal.size[1]; ++j)
      for (int i = 0; i < canal.size[0]; ++i) {
        if (!(canal.at(i, j, k) > 0)) continue;
        const Vec3 p = canal.to_world_mm({double(i), double(j), double(k)});
        sum_x += p.x;
        level.z += p.z;
        count += 1;
        front = std::min(front, p.y);
        back = std::max(back, p.y);
      }
    if (count < 4) continue;
    level.known = true;
    level.x = sum_x / count;
    level.z /= count;
    level.y = front + behind_front * (back - front);
    all.push_back(level);
  }
  std::sort(all.begin(), all.end(), [](const Level& a, const Level& b) { return a.z < b.z; });
  // A course is smooth: a foramen in the wall moves one slice's front.
  std::vector<Level> smooth = all;
  for (std::size_t n = 0; n < all.size(); ++n) {
    double x = 0, y = 0, count = 0;
    for (const Level& other : all)
      if (std::abs(other.z - all[n].z) <= 5) x += other.x, y += other.y, count += 1;
    smooth[n].x = x / count;
    smooth[n].y = y / count;
  }
  return smooth;
}

// The canal's direction at that height, over 15 mm each way.
Vec3 along(const std::vector<Level>& levels, double z) {
  const Level *low = &levels.front(), *high = &levels.back();
  for (const Level& l : levels) {
    if (l.z <= z - 15) low = &l;
    if (l.z >= z + 15) {
      high = &l;
      break;
    }
  }
  return normalized({high->x - low->x, high->y - low->y, high->z - low->z});
}

// The middle of the bone beside the canal; false where there is none near.
bool chord(const grid::Field& bone, const grid::Field& canal, const Level& at, double side, double& middle_x) {
  double x = at.x;
  const auto point = [&] { return Vec3{x, at.y, at.z}; };
  double walked = 0;
  while (walked < 25 && field_at(canal, point(), -1) > 0) x += side * step_mm, walked += step_mm;
  double gap = 0;
  while (gap <= max_gap_mm && !(field_at(bone, point(), -1) > 0)) x += side * step_mm, gap += step_mm;
  if (gap > max_gap_mm) return false;
  const double begin = x;
  while (std::abs(x - begin) < max_chord_mm && field_at(bone, point(), -1) > 0) x += side * step_mm;
  if (std::abs(x - begin) < min_chord_mm) return false;
  middle_x = 0.5 * (begin + x);
  return true;
}

}  // namespace

std::vector<PediclePlace> pedicle_places(const grid::Field& bone, const grid::Field& canal,
                                         const PediclesParams& params) {
  const std::vector<Level> levels = levels_of(canal);
  std::vector<PediclePlace> all;
  if (levels.size() < 2) return all;
  // Two slices that follow each other have no hole between them, however thick they are.
  const double max_step_mm = std::max(max_hole_mm, canal.spacing_mm.z) + step_mm;
  for (const bool left : {true, false}) {
    struct Run {
      double first, last;
      std::vector<Vec3> middles;
    };
    std::vector<Run> runs;
    for (const Level& level : levels) {
      double x = 0;
      if (!chord(bone, canal, level, left ? 1 : -1, x)) continue;
      if (runs.empty() || level.z - runs.back().last > max_step_mm) runs.push_back({level.z, level.z, {}});
      runs.back().last = level.z;
      runs.back().middles.push_back({x, level.y, level.z});
    }
    for (const Run& run : runs) {
      PediclePlace place;
      place.left = left;
      place.height_mm = run.last - run.first;
      if (place.height_mm < params.min_height_mm) continue;
      place.cut = run.first <= levels.front().z + 0.5 || run.last >= levels.back().z - 0.5;
      place.at_mm = run.middles[run.middles.size() / 2];
      place.up = along(levels, place.at_mm.z);
      all.push_back(place);
    }
  }
  std::sort(all.begin(), all.end(), [](const PediclePlace& a, const PediclePlace& b) { return a.at_mm.z < b.at_mm.z; });
  return all;
}

}  // namespace trephine::trunk
