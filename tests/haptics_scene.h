// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Volumes and materials that a hand can meet in tests.
#include <cmath>
#include <functional>
#include <random>

#include "contact_walls.h"
#include "haptics/proxy.h"

namespace trephine::haptic_scenes {

inline cases::CaseFace face(double stiffness, double static_friction = 0, double dynamic_friction = 0, double pop = 0,
                            double damping = 0) {
  cases::CaseFace f;
  f.stiffness_n_per_mm = stiffness;
  f.damping_n_s_per_mm = damping;
  f.static_friction_ratio = static_friction;
  f.dynamic_friction_ratio = dynamic_friction;
  f.pop_through_n = pop;
  return f;
}

/// Shape `number` filled where level(world) > 0, level being about a distance in mm.
inline void fill(voxel::HapticVolume& v, int number, const std::function<double(Vec3)>& level) {
  const double side = std::cbrt(v.voxels.voxel_volume_mm3());
  for (int k = 0; k < v.voxels.size[2]; ++k)
    for (int j = 0; j < v.voxels.size[1]; ++j)
      for (int i = 0; i < v.voxels.size[0]; ++i) {
        const double d = level(v.voxels.to_world_mm({double(i), double(j), double(k)})) / side;
        const int o = int(std::lround(255 * std::clamp(0.5 + d, 0.0, 1.0)));
        if (o > 0) v.voxels.at(i, j, k) = std::int16_t(1000 * number + o + (o < 255 ? 300 : 0));
      }
  v.shapes.push_back(voxel::occupancy_shape("shape_" + std::to_string(number), number));
}

/// n^3 voxels about the origin, along the axes.
inline voxel::HapticVolume empty(int n, Vec3 spacing_mm) {
  grid::Lattice l;
  l.size = {n, n, n};
  l.spacing_mm = spacing_mm;
  l.origin_mm = spacing_mm * (-0.5 * (n - 1));
  voxel::HapticVolume v;
  v.voxels = grid::Grid<std::int16_t>(l, voxel::haptic_empty);
  return v;
}

inline haptics::Feels untouchable() {
  haptics::Feels f;
  for (haptics::ShapeFeel& s : f) s.front.touchable = s.back.touchable = false;
  return f;
}
inline haptics::Feels one_shape(int number, const cases::CaseFace& front, const cases::CaseFace& back) {
  haptics::Feels f = untouchable();
  f[std::size_t(number)].front = front;
  f[std::size_t(number)].back = back;
  return f;
}

/// No ramp, no filter, and limits that do not bind.
inline haptics::ForceParams plain() {
  haptics::ForceParams p;
  p.max_force_n = 100;
  p.max_force_rate_n_per_s = 1e6;
  p.ramp_s = 0;
  p.velocity_cutoff_hz = 0;
  p.release_s = 0;
  return p;
}

inline haptics::HapticInput at(Vec3 tip_mm, double dt_s = 0.001) {
  haptics::HapticInput in;
  in.tip_mm = tip_mm;
  in.dt_s = dt_s;
  return in;
}

}  // namespace trephine::haptic_scenes
