// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "cases/load_case.h"
#include "phantom/head.h"

namespace trephine {

// As a scene of a ventriculostomy has it, of the analytic shapes.
inline cases::LoadedCase case_of(const phantom::Head& head) {
  grid::Lattice l;
  l.size = {128, 150, 112};
  l.spacing_mm = {1.4, 1.4, 1.4};
  l.origin_mm = {-89, -112, -12};
  cases::LoadedCase out;
  out.haptic.voxels = grid::Grid<std::int16_t>(l);
  out.haptic.shapes = {voxel::occupancy_shape("ventricles", 1), voxel::occupancy_shape("skull", 2),
                       voxel::occupancy_shape("brain", 3)};
  parallel_for(0, l.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
          const auto share = [&](phantom::Anatomy a) {
            return std::clamp(0.5 - head.implicit_mm(a, p) / l.spacing_mm.x, 0.0, 1.0);
          };
          // Without its air cells, which a case's own CT would show: this one has none.
          const double bone = head.hu(p) > -300 ? share(phantom::Anatomy::skull) : 0,
                       brain = share(phantom::Anatomy::brain), liquor = share(phantom::Anatomy::ventricles);
          const auto value = [](int number, double o) {
            const int part = int(std::lround(255 * o));
            return std::int16_t(part == 0 ? 0 : 1000 * number + (part < 255 ? 300 : 0) + part);
          };
          out.haptic.voxels.at(i, j, k) = bone > 0 ? value(2, bone) : liquor > 0.5 ? value(1, liquor) : value(3, brain);
        }
  });
  out.manifest.case_token = "phantom";
  for (const auto& [name, at] : head.landmarks()) out.manifest.landmarks.push_back({name, at, 1, "truth"});
  return out;
}

inline Vec3 landmark_mm(const cases::LoadedCase& of, const std::string& name) {
  for (const cases::CaseLandmark& l : of.manifest.landmarks)
    if (l.name == name) return l.position_mm;
  return {};
}

}  // namespace trephine
