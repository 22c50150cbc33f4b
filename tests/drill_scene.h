// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Volumes to drill in, and drills.
#include <algorithm>
#include <cmath>
#include <random>

#include "drill/drill.h"
#include "voxel/raw_voxel.h"

namespace trephine::drilling {

inline double uniform(std::mt19937_64& rng, double lo, double hi) {
  return lo + (hi - lo) * double(rng() >> 11) * 0x1p-53;
}

inline grid::Lattice lattice(int n, double spacing_mm) {
  grid::Lattice l;
  l.size = {n, n, n};
  l.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  const Vec3 z = normalized(Vec3{0.2, -0.3, 0.9});
  l.direction.column[2] = z;
  l.direction.column[0] = normalized(cross(Vec3{0.1, 1, 0.3}, z));
  l.direction.column[1] = cross(z, l.direction.column[0]);
  l.origin_mm = {-31.7, 12.3, 8.9};
  return l;
}

/// The whole lattice full of shape 1.
inline voxel::HapticVolume full(int n, double spacing_mm) {
  voxel::HapticVolume v;
  v.voxels = grid::Grid<std::int16_t>(lattice(n, spacing_mm), std::int16_t(1255));
  v.shapes = {voxel::occupancy_shape("bone", 1)};
  return v;
}

/// Skin (1), bone (2) and brain (3) in layers along z, wavy, with shared voxels where they meet; they reach the border.
inline voxel::HapticVolume layers(int n, double spacing_mm) {
  voxel::HapticVolume v;
  v.voxels = grid::Grid<std::int16_t>(lattice(n, spacing_mm), voxel::haptic_empty);
  v.shapes = {voxel::occupancy_shape("skin", 1), voxel::occupancy_shape("bone", 2), voxel::occupancy_shape("brain", 3)};
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double z = k + 1.5 * std::sin(0.31 * i) + 1.2 * std::cos(0.23 * j + 0.1 * i);
        const double brain = z - 0.35 * n, bone = z - 0.65 * n, skin = z - 0.85 * n;  // in voxels, 0 at the upper end
        const int own = brain < 0 ? 3 : bone < 0 ? 2 : 1;
        const double upper = own == 3   ? brain
                             : own == 2 ? bone
                                        : skin,
                     lower = own == 2   ? brain
                             : own == 1 ? bone
                                        : -1e9;
        const double d = std::min(-upper, own == 3 ? 1e9 : lower);
        const int share = int(std::lround(255 * std::clamp(0.5 + 0.4 * d, 0.0, 1.0)));
        if (share == 0) continue;
        const bool air = own == 1 && -upper < lower;
        v.voxels.at(i, j, k) = voxel::detail::join(own, share, air && share < 255);
      }
  return v;
}

inline drill::DrillShapes only(int number, double energy_j_per_mm3) {
  drill::DrillShapes s;
  s[std::size_t(number)] = {true, energy_j_per_mm3};
  return s;
}
/// Skin that is cut, not drilled; bone; brain, neither.
inline drill::DrillShapes of_layers() {
  drill::DrillShapes s = only(2, 0.1);
  s[1] = {true, 0};
  return s;
}

inline drill::Cutter ball(double radius_mm) {
  drill::Cutter c;
  c.radius_mm = radius_mm;
  return c;
}

/// The pose of a ball with that centre.
inline drill::ToolPose centred(Vec3 centre_mm, double radius_mm) {
  drill::ToolPose p;
  p.tip_mm = centre_mm - p.frame.column[2] * radius_mm;
  return p;
}

/// The tool runs, and came to this pose.
inline const drill::Removal& cut(drill::Drill& drill, const drill::ToolPose& pose, double dt_s, double power = 1) {
  return drill.cut_way(pose, pose.tip_mm, 0, dt_s, power);
}

inline double mm3(const voxel::HapticVolume& v, std::int64_t units) {
  return double(units) / voxel::haptic_full * v.voxels.voxel_volume_mm3();
}

inline Vec3 middle(const voxel::HapticVolume& v) {
  const auto& n = v.voxels.size;
  return v.voxels.to_world_mm({0.5 * (n[0] - 1), 0.5 * (n[1] - 1), 0.5 * (n[2] - 1)});
}

}  // namespace trephine::drilling
