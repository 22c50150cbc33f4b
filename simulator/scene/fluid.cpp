// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/fluid.h"

#include <cmath>

namespace trephine::scene {
namespace {

constexpr double bead_apart_mm = 14, bead_mm_per_s = 22;
constexpr double drop_each_s = 0.7, swells_s = 0.45,
                 drop_mm = 3.2;  // a quick drip, of an opening pressure that is high
constexpr double gravity_mm_per_s2 = 9810;
constexpr std::array<float, 3> csf_rgb{0.80f, 0.90f, 0.97f};

}  // namespace

std::vector<Marker> csf_drops(Vec3 tip, Vec3 axis, Vec3 down, double tube_radius_mm, double to_mm, double time_s) {
  std::vector<Marker> drops;
  for (double at = std::fmod(time_s * bead_mm_per_s, bead_apart_mm); at < to_mm; at += bead_apart_mm)
    drops.push_back({tip + axis * at, 1.2 * tube_radius_mm, csf_rgb});
  const double phase_s = std::fmod(time_s, drop_each_s);
  const double size = drop_mm * std::cbrt(std::min(1.0, phase_s / swells_s));
  const double falls_s = std::max(0.0, phase_s - swells_s);
  const Vec3 end = tip + axis * to_mm;
  drops.push_back({end + down * (0.5 * size + 0.5 * gravity_mm_per_s2 * falls_s * falls_s), size, csf_rgb});
  return drops;
}

}  // namespace trephine::scene
