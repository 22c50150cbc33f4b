// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A head of spheres and ellipsoids in which lessons are done: every length in it is known.
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "lessons_case.h"

namespace lesson_cases {

using namespace trephine;

constexpr double skin_mm = 92, outer_mm = 86, inner_mm = 79, brain_mm = 77;  // radii about the origin
const Vec3 foramen{-3, -5, 22};                                              // of the right; the left one mirrors it

/// A direction: degrees above the nose, and to the patient's right.
inline Vec3 towards(double up_deg, double right_deg) {
  const double u = up_deg * M_PI / 180, r = right_deg * M_PI / 180;
  return {-std::sin(r), -std::cos(r) * std::cos(u), std::cos(r) * std::sin(u)};
}
constexpr double nasion_deg = 10;
inline double deg_of(double skin_arc_mm) { return skin_arc_mm / skin_mm * 180 / M_PI; }
inline Vec3 kocher(bool left = false) {
  const Vec3 d = towards(nasion_deg + deg_of(110), deg_of(27.5));
  return Vec3{left ? -d.x : d.x, d.y, d.z} * skin_mm;
}
inline Vec3 bregma() { return towards(nasion_deg + deg_of(125), 0) * outer_mm; }

/// About the distance to the ventricles' surface, positive inside.
inline double in_ventricles(Vec3 p) {
  const auto ellipsoid = [&](Vec3 c, Vec3 r) {
    const Vec3 d = p - c;
    return (1 - norm({d.x / r.x, d.y / r.y, d.z / r.z})) * std::min({r.x, r.y, r.z});
  };
  const double side = std::max(ellipsoid({-9.5, -8, 28}, {9, 22, 9.5}), ellipsoid({9.5, -8, 28}, {9, 22, 9.5}));
  return std::max(side, ellipsoid({0, -3, 11}, {3, 12, 9}));
}

enum class Kind { whole, drilled };

/// `dura`: what lies between brain and bone is a fifth shape; else it is nothing.
inline voxel::HapticVolume volume_of(Kind kind, bool dura = false) {
  constexpr double side = 0.9;
  constexpr int n = 216;
  voxel::HapticVolume v;
  grid::Lattice l;
  l.size = {n, n, n};
  l.spacing_mm = {side, side, side};
  l.origin_mm = Vec3{1, 1, 1} * (-side * (n - 1) / 2);
  v.voxels = grid::Grid<std::int16_t>(l);
  v.shapes = {voxel::occupancy_shape("ventricles", 1), voxel::occupancy_shape("brain", 2),
              voxel::occupancy_shape("skull", 3), voxel::occupancy_shape("skin", 4)};
  if (dura) v.shapes.push_back(voxel::occupancy_shape("dura", 5));
  const Vec3 axis = normalized(kocher());
  parallel_for(0, n, 1, [&](std::int64_t k, std::int64_t) {
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
        const double r = norm(p);
        // The hole, 14 mm wide through bone and 26 mm through skin.
        const double off = norm(p - axis * dot(p, axis));
        const bool above = dot(p, axis) > 0;
        const double bone_hole = kind == Kind::drilled && above ? 7 - off : -1e3;
        const double skin_hole = kind == Kind::drilled && above ? 13 - off : -1e3;
        const std::array<double, 5> depth = {in_ventricles(p), std::min(brain_mm - r, -in_ventricles(p)),
                                             std::min({outer_mm - r, r - inner_mm, -bone_hole}),
                                             std::min({skin_mm - r, r - outer_mm, -skin_hole}),
                                             dura ? std::min(inner_mm - r, r - brain_mm) : -1e3};
        v.voxels.at(i, j, int(k)) = voxel_of(depth, side);
      }
  });
  return v;
}

inline case_samples::MemoryCase make_head_case(Kind kind, double suture_confidence, bool dura) {
  const voxel::HapticVolume volume = volume_of(kind, dura);
  case_samples::MemoryCase c = case_of(kind == Kind::drilled ? "head-drilled" : "head", volume);
  cases::CaseManifest& m = c.manifest;
  m.figures = {{"class", std::string("normal")}};
  // As configs/materials.yaml has them.
  const cases::CaseFace liquor{true, 0.12, 0.0002, 0.2, 0.15, 0.6}, none{false, 0, 0, 0, 0, 0};
  add_shape(m, volume.shapes[0], "csf", {{}, liquor, liquor, 0.001, 0, 0}, false);
  add_shape(m, volume.shapes[1], "brain", {{}, {true, 0.08, 0.0002, 0.3, 0.25, 0.4}, none, 0.01, 0.003, 0}, false);
  const cases::CaseFace bone{true, 1, 0.0003, 0.35, 0.3, 0};
  add_shape(m, volume.shapes[2], "bone", {{}, bone, bone, 0, 0, 0.1}, kind == Kind::whole);
  add_shape(m, volume.shapes[3], "skin", {{}, {true, 0.3, 0.0003, 0.35, 0.3, 2}, none, 0.01, 0.01, 0},
            kind == Kind::whole);
  if (dura)
    add_shape(m, volume.shapes[4], "dura", {{}, {true, 0.35, 0.0002, 0.3, 0.25, 1}, none, 0.01, 0.01, 0}, false);
  const auto landmark = [&](const char* name, Vec3 p, double confidence = 1) {
    m.landmarks.push_back({name, p, confidence, "truth"});
  };
  landmark("nasion", towards(nasion_deg, 0) * skin_mm);
  landmark("inion", Vec3{0, 0.99, -0.141} * skin_mm);
  landmark("vertex", Vec3{0, 0, skin_mm});
  landmark("bregma", bregma(), suture_confidence);
  landmark("kocher_right", kocher());
  landmark("kocher_left", kocher(true));
  m.targets = {{"monro_right", foramen, 1, "ventricles"},
               {"monro_left", {-foramen.x, foramen.y, foramen.z}, 1, "ventricles"}};
  if (kind == Kind::drilled)
    m.burr_holes = {{"hole",
                     normalized(kocher()) * outer_mm,
                     -normalized(kocher()),
                     14,
                     {"skull"},
                     {{"bone_thickness_mm", outer_mm - inner_mm}}}};
  c.seal();
  return c;
}

/// Made once for each set of arguments: many lessons are done on few heads.
inline case_samples::MemoryCase head_case(Kind kind, double suture_confidence = 1, bool dura = false) {
  static std::map<std::tuple<Kind, double, bool>, case_samples::MemoryCase> made;
  const std::tuple key{kind, suture_confidence, dura};
  if (made.count(key) == 0) made.emplace(key, make_head_case(kind, suture_confidence, dura));
  return made.at(key);
}

}  // namespace lesson_cases
