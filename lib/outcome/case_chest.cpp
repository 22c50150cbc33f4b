// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/case_chest.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace trephine::outcome {
namespace {

constexpr double points_mm = 4, clavicle_points_mm = 2.5;
constexpr double least_apart_mm = 10;  // over the sternum; a sternum is some 40 mm wide

}  // namespace

bool is_chest(const cases::LoadedCase& loaded) {
  return loaded.has_haptic() && loaded.haptic.find_shape("clavicle") && loaded.haptic.find_shape("skin");
}

CaseChest::CaseChest(const cases::LoadedCase& of) : loaded(of), decoder(of.haptic) {
  const std::pair<const char*, int*> known[] = {
      {"skin", &skin},     {"clavicle", &clavicle}, {"other_bone", &other_bone}, {"vein", &vein},
      {"artery", &artery}, {"lung", &lung},         {"pleura", &pleura}};
  for (const auto& [name, number] : known)
    if (const voxel::HapticShape* shape = of.haptic.find_shape(name)) *number = shape->number;
  const std::vector<BonePoint> both = bone_points(of.haptic, clavicle, clavicle_points_mm);
  double middle = 0;
  for (const BonePoint& p : both) middle += p.at_mm.x / double(both.size());
  for (const BonePoint& p : both) clavicles[p.at_mm.x > middle].push_back(p);
  double last_mm = -1e9, first_mm = 1e9;  // of the two, along the patient's left
  for (const BonePoint& p : clavicles[0]) last_mm = std::max(last_mm, p.at_mm.x);
  for (const BonePoint& p : clavicles[1]) first_mm = std::min(first_mm, p.at_mm.x);
  if (!(first_mm - last_mm > least_apart_mm))
    throw Error(
        ExitCode::bad_input, "", "haptic.shapes.clavicle",
        "the case shows one clavicle, and sides are told by two; make it of a series that holds both shoulders");
  for (const int side : {0, 1})
    for (const BonePoint& p : clavicles[std::size_t(side)])
      clavicle_mm[std::size_t(side)] += p.at_mm * (1.0 / double(clavicles[std::size_t(side)].size()));
  left = normalized(clavicle_mm[1] - clavicle_mm[0]);
  // Shoulders move with the arms.
  const Vec3 between = (clavicle_mm[0] + clavicle_mm[1]) * 0.5;
  const double reach = 0.5 * norm(clavicle_mm[1] - clavicle_mm[0]);
  for (const BonePoint& p : other_bone != 0 ? bone_points(of.haptic, other_bone, points_mm) : std::vector<BonePoint>())
    if (std::abs(dot(p.at_mm - between, left)) < reach) thorax.push_back(p);
}

bool CaseChest::is_patient(Vec3 p) const {
  const grid::Lattice& l = loaded.haptic.voxels;
  Vec3 at = l.to_index(p);
  at.z = std::clamp(at.z, 1.0, std::max(1.0, double(l.size[2] - 2)));
  const Vec3 q = l.to_world_mm(at);
  double sum = 0;
  for (const voxel::HapticShape& shape : loaded.haptic.shapes) sum += decoder.trilinear(shape.number, q);
  return sum >= 0.5;
}

}  // namespace trephine::outcome
