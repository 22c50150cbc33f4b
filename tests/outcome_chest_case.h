// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "cases/load_case.h"
#include "phantom/body_scan.h"
#include "phantom/chest.h"

namespace trephine {

inline Vec3 chest_offset_mm() { return phantom::default_centre_mm() - Vec3{0, -5, -5}; }

// As a scene of a chest has it, of the analytic shapes, in the scanner's frame.
inline cases::LoadedCase case_of(const phantom::Chest& chest) {
  constexpr double side = 1.6;
  grid::Lattice l;
  l.size = {194, 118, 66};
  l.spacing_mm = {side, side, side};
  l.origin_mm = {-side * 193 / 2, -98, -56};
  cases::LoadedCase out;
  out.haptic.voxels = grid::Grid<std::int16_t>(l);
  int number = 0;
  for (const char* name : {"clavicle", "other_bone", "vein", "artery", "lung", "skin"})
    out.haptic.shapes.push_back(voxel::occupancy_shape(name, ++number));
  parallel_for(0, l.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
          const double depth[] = {chest.clavicle(p), chest.other_bone(p), chest.vein(p),
                                  chest.artery(p),   chest.lung(p),       chest.skin(p)};
          for (int s = 0; s < 6; ++s) {  // the first that is there
            const int part = int(std::lround(255 * std::clamp(0.5 + depth[s] / side, 0.0, 1.0)));
            if (part == 0) continue;
            const bool air = part < 255 && depth[5] < side;
            out.haptic.voxels.at(i, j, k) = std::int16_t(1000 * (s + 1) + (air ? 300 : 0) + part);
            break;
          }
        }
  });
  static_cast<grid::Lattice&>(out.haptic.voxels).origin_mm += chest_offset_mm();
  out.manifest.case_token = "phantom";
  return out;
}

}  // namespace trephine
