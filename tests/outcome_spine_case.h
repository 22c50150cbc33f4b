// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "cases/load_case.h"
#include "phantom/body_scan.h"
#include "phantom/spine.h"

namespace trephine {

// As a scene of a spine has it, of the analytic shapes: bone to be felt, and pedicles. In the scanner's frame.
inline cases::LoadedCase case_of(const phantom::Spine& spine) {
  const Vec3 offset = phantom::default_centre_mm() - Vec3{0, 10, 0};
  constexpr double side = 0.9;
  grid::Lattice l = phantom::lattice_about(spine, {side, side, side}, 62);
  cases::LoadedCase out;
  out.haptic.shapes = {voxel::occupancy_shape("bone", 1)};
  out.haptic.voxels = grid::Grid<std::int16_t>(l);
  parallel_for(0, l.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const double bone = spine.bone(l.to_world_mm({double(i), double(j), double(k)}));
          const int part = int(std::lround(255 * std::clamp(0.5 + bone / side, 0.0, 1.0)));
          out.haptic.voxels.at(i, j, k) = std::int16_t(part == 0 ? 0 : 1000 + (part < 255 ? 300 : 0) + part);
        }
  });
  static_cast<grid::Lattice&>(out.haptic.voxels).origin_mm += offset;
  out.manifest.case_token = "phantom";
  for (const phantom::Spine::Pedicle& p : spine.pedicles()) {
    double behind = 0, before = 0;
    while (spine.bone(p.middle_mm - p.forwards * behind) > 0) behind += 0.1;
    while (spine.bone(p.middle_mm + p.forwards * before) > 0) before += 0.1;
    const Vec3 entry = p.middle_mm - p.forwards * behind + offset;
    const std::string name = "pedicle_" + std::to_string(p.vertebra + 1) + (p.left ? "_left" : "_right");
    out.manifest.landmarks.push_back({name + "_entry", entry, 1, "truth"});
    out.manifest.landmarks.push_back({name + "_target", entry + p.forwards * (0.75 * (behind + before)), 1, "truth"});
  }
  return out;
}

}  // namespace trephine
