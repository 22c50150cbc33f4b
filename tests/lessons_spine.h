// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A spine of plain shapes in which lessons are done: its pedicles are known exactly.
#include <map>

#include "grid/nrrd.h"
#include "lessons_case.h"
#include "phantom/spine.h"

namespace lesson_cases {

using namespace trephine;

inline voxel::HapticVolume spine_volume(const phantom::Spine& spine) {
  constexpr double side = 0.8;
  voxel::HapticVolume v;
  grid::Lattice l = phantom::lattice_about(spine, {side, side, side}, 62);
  v.voxels = grid::Grid<std::int16_t>(l);
  v.shapes = {voxel::occupancy_shape("bone", 1), voxel::occupancy_shape("canal", 2), voxel::occupancy_shape("skin", 3)};
  parallel_for(0, l.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
          const double bone = spine.bone(p), canal = std::min(spine.canal(p), -bone);
          // Skin: within 55 mm of the middle, so that air is before it in a volume of this size.
          const double body = 55 - std::abs(p.y - 10);
          v.voxels.at(i, j, k) = voxel_of<3>({bone, canal, std::min({body, -bone, -spine.canal(p)})}, side);
        }
  });
  return v;
}

/// What X-rays see of it.
inline grid::Grid<std::int16_t> spine_ct(const phantom::Spine& spine) {
  constexpr double side = 1;
  grid::Grid<std::int16_t> ct(phantom::lattice_about(spine, {side, side, side}, 62), -1000);
  parallel_for(0, ct.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < ct.size[1]; ++j)
        for (int i = 0; i < ct.size[0]; ++i) {
          const Vec3 p = ct.to_world_mm({double(i), double(j), double(k)});
          const auto share = [](double inside_mm) { return std::clamp(0.5 + inside_mm / side, 0.0, 1.0); };
          ct.at(i, j, k) =
              std::int16_t(std::lround(-1000 + 1040 * share(55 - std::abs(p.y - 10)) + 700 * share(spine.bone(p))));
        }
  });
  return ct;
}

/// Entry and target of a pedicle, as `trephine pedicles` gives them for the truth.
inline std::pair<Vec3, Vec3> ends_of(const phantom::Spine& spine, const phantom::Spine::Pedicle& p) {
  double behind = 0, before = 0;
  while (spine.bone(p.middle_mm - p.forwards * behind) > 0) behind += 0.1;
  while (spine.bone(p.middle_mm + p.forwards * before) > 0) before += 0.1;
  const Vec3 entry = p.middle_mm - p.forwards * behind;
  return {entry, entry + p.forwards * (0.75 * (behind + before))};
}

inline case_samples::MemoryCase make_spine_case(double confidence) {
  const phantom::Spine spine;
  const voxel::HapticVolume volume = spine_volume(spine);
  case_samples::MemoryCase c = case_of("spine", volume);
  cases::CaseManifest& m = c.manifest;
  const grid::Grid<std::int16_t> ct = spine_ct(spine);
  const std::string ct_bytes = grid::encode_nrrd(ct, {}, grid::NrrdEncoding::gzip);
  m.files.push_back(cases::describe_case_file("ct", ".nrrd", ct_bytes));
  m.ct = {m.files.back().name, ct.size, ct.spacing_mm};
  c.files[m.ct.file] = ct_bytes;
  // As configs/materials.yaml has them.
  const cases::CaseFace bone{true, 1, 0.0003, 0.35, 0.3, 0}, liquor{true, 0.12, 0.0002, 0.2, 0.15, 0.6},
      none{false, 0, 0, 0, 0, 0};
  add_shape(m, volume.shapes[0], "bone", {{}, bone, bone, 0, 0, 0.1}, false, {0.93, 0.89, 0.78});
  add_shape(m, volume.shapes[1], "csf", {{}, liquor, liquor, 0.001, 0, 0}, false, {0.30, 0.60, 0.80});
  add_shape(m, volume.shapes[2], "soft_tissue", {{}, {true, 0.25, 0.0003, 0.35, 0.3, 1}, none, 0.015, 0.012, 0}, false,
            {0.87, 0.68, 0.56});
  for (const phantom::Spine::Pedicle& p : spine.pedicles()) {
    const auto [entry, target] = ends_of(spine, p);
    const std::string name = "pedicle_" + std::to_string(p.vertebra + 1) + (p.left ? "_left" : "_right");
    m.landmarks.push_back({name + "_entry", entry, confidence, "truth"});
    m.landmarks.push_back({name + "_target", target, confidence, "truth"});
  }
  c.seal();
  return c;
}

inline case_samples::MemoryCase spine_case(double confidence = 1) {
  static std::map<double, case_samples::MemoryCase> made;  // once each, as heads are
  if (made.count(confidence) == 0) made.emplace(confidence, make_spine_case(confidence));
  return made.at(confidence);
}

}  // namespace lesson_cases
