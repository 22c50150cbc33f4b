// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A chest of cylinders and balls in which a needle goes to the vein: every length in it is known.
#include <map>

#include "lessons_case.h"

namespace lessons_chest {

using namespace trephine;

// Along x on both sides: clavicles from 12 to 100 mm beside the middle, veins and arteries under them.
constexpr double front_y = -50, clavicle_y = -35, clavicle_z = 10, clavicle_r = 6, vein_y = -15, vein_z = 2, vein_r = 6,
                 artery_y = 3, artery_z = 4, artery_r = 4;
const Vec3 lung_centre{55, 25, -45};
constexpr double lung_r = 45, pleura_r = 47;

inline double tube(Vec3 p, double y, double z, double r, double from, double to) {
  const double x = std::abs(p.x);
  return std::min({r - std::hypot(p.y - y, p.z - z), x - from, to - x});
}

inline voxel::HapticVolume volume_of(bool artery) {
  constexpr double side = 1.25;
  voxel::HapticVolume v;
  grid::Lattice l;
  l.size = {178, 80, 98};
  l.spacing_mm = {side, side, side};
  l.origin_mm = {-side * 177 / 2, -60, -60};
  v.voxels = grid::Grid<std::int16_t>(l);
  v.shapes = {voxel::occupancy_shape("clavicle", 1), voxel::occupancy_shape("vein", 2),
              voxel::occupancy_shape("lung", 3), voxel::occupancy_shape("pleura", 4),
              voxel::occupancy_shape("skin", 5)};
  if (artery) v.shapes.push_back(voxel::occupancy_shape("artery", 6));
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
        const Vec3 beside{std::abs(p.x), p.y, p.z};
        const double lung = lung_r - norm(beside - lung_centre), pleura = pleura_r - norm(beside - lung_centre);
        std::array<double, 6> depth = {tube(p, clavicle_y, clavicle_z, clavicle_r, 12, 100),
                                       tube(p, vein_y, vein_z, vein_r, 5, 80),
                                       lung,
                                       std::min(pleura, -lung),
                                       0,
                                       artery ? tube(p, artery_y, artery_z, artery_r, 5, 80) : -1e3};
        const double body = std::min({105 - std::abs(p.x), p.y - front_y, 33 - p.y, 55 - std::abs(p.z)});
        depth[2] = std::min(depth[2], body);
        depth[3] = std::min(depth[3], body);
        depth[4] = std::min(body, -std::max({depth[0], depth[1], pleura, depth[5]}));
        v.voxels.at(i, j, k) = ::lesson_cases::voxel_of(depth, side);
      }
  return v;
}

inline case_samples::MemoryCase make_chest_case(bool artery) {
  const voxel::HapticVolume volume = volume_of(artery);
  case_samples::MemoryCase c = ::lesson_cases::case_of(artery ? "chest-artery" : "chest", volume);
  cases::CaseManifest& m = c.manifest;
  // As configs/materials.yaml has them.
  const cases::CaseFace none{false, 0, 0, 0, 0, 0}, bone{true, 1, 0.0003, 0.35, 0.3, 0};
  const cases::CaseFace wall{true, 0.2, 0.0002, 0.2, 0.15, 0.7}, far_wall{true, 0.2, 0.0002, 0.2, 0.15, 0.9};
  ::lesson_cases::add_shape(m, volume.shapes[0], "bone", {{}, bone, bone, 0, 0, 0.1}, false);
  ::lesson_cases::add_shape(m, volume.shapes[1], "vein", {{}, wall, far_wall, 0.001, 0.002, 0}, false);
  ::lesson_cases::add_shape(m, volume.shapes[2], "lung", {{}, none, none, 0.001, 0.001, 0}, false);
  ::lesson_cases::add_shape(m, volume.shapes[3], "pleura",
                            {{}, {true, 0.15, 0.0002, 0.2, 0.15, 0.5}, none, 0.01, 0.01, 0}, false);
  ::lesson_cases::add_shape(m, volume.shapes[4], "soft_tissue",
                            {{}, {true, 0.15, 0.0003, 0.3, 0.25, 0.8}, none, 0.015, 0.012, 0}, false);
  if (artery) ::lesson_cases::add_shape(m, volume.shapes[5], "vein", {{}, wall, far_wall, 0.001, 0.002, 0}, false);
  c.seal();
  return c;
}

inline case_samples::MemoryCase chest_case(bool artery) {
  static std::map<bool, case_samples::MemoryCase> made;  // once each, as heads are
  if (made.count(artery) == 0) made.emplace(artery, make_chest_case(artery));
  return made.at(artery);
}

}  // namespace lessons_chest
