// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/subclavian/chest_frame.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "voxel/decode.h"

namespace trephine::lessons {
namespace {

constexpr double end_mm = 8;      // of a clavicle, whose middle is its medial end
constexpr double min_gap_mm = 4;  // between the two medial ends
constexpr double slab_mm = 2;     // in which the vein's middle is taken

void each_voxel(const voxel::HapticVolume& v, int shape, const std::function<void(Vec3)>& visit) {
  const voxel::HapticDecoder decoder(v);
  const auto& size = v.voxels.size;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i)
        if (decoder.shape_at(i, j, k) == shape) visit(v.voxels.to_world_mm({double(i), double(j), double(k)}));
}

int column_of(double x) { return int(std::floor(x / ChestFrame::border_step_mm)); }

struct Mean {
  Vec3 sum;
  double count = 0;
  void add(Vec3 p) {
    sum += p;
    ++count;
  }
  Vec3 value() const { return sum / count; }
};

}  // namespace

ChestShapes chest_shapes_of(const cases::CaseManifest& manifest) {
  ChestShapes s;
  for (const cases::CaseShape& shape : manifest.haptic.shapes) {
    const std::pair<const char*, int*> known[] = {{"skin", &s.skin},     {"clavicle", &s.clavicle}, {"vein", &s.vein},
                                                  {"artery", &s.artery}, {"pleura", &s.pleura},     {"lung", &s.lung}};
    for (const auto& [name, number] : known)
      if (shape.name == name) *number = shape.number;
  }
  if (s.skin == 0 || s.clavicle == 0 || s.vein == 0)
    throw Error(ExitCode::bad_input, "", "haptic.shapes", "the lesson needs skin, clavicle and vein that are felt");
  return s;
}

ChestFrame chest_frame_of(const voxel::HapticVolume& volume, const ChestShapes& shapes) {
  ChestFrame f;
  double least = 1e9, most = -1e9;
  each_voxel(volume, shapes.clavicle, [&](Vec3 p) {
    least = std::min(least, p.x);
    most = std::max(most, p.x);
    double& z = f.border_z_mm.try_emplace(column_of(p.x), p.z).first->second;
    z = std::min(z, p.z);
  });
  // The patient's right is at smaller x. The gap that is nearest to the middle parts the two.
  const double middle = (least + most) / 2;
  double right_end = -1e9, left_end = 1e9;
  for (const auto& [column, z] : f.border_z_mm) {
    const double x = (column + 0.5) * ChestFrame::border_step_mm;
    if (x < middle) right_end = std::max(right_end, x);
    if (x > middle) left_end = std::min(left_end, x);
  }
  if (f.border_z_mm.empty() || left_end - right_end < min_gap_mm)
    throw Error(ExitCode::bad_input, "", "haptic.shapes.clavicle",
                "is not two bones beside each other, between which the sternal notch would lie");
  Mean ends[2];
  each_voxel(volume, shapes.clavicle, [&](Vec3 p) {
    if (p.x <= right_end + 2 && p.x > right_end - end_mm) ends[0].add(p);
    if (p.x >= left_end - 2 && p.x < left_end + end_mm) ends[1].add(p);
  });
  f.notch_mm = (ends[0].value() + ends[1].value()) / 2;
  const double thirds[2] = {right_end + (least - right_end) / 3, left_end + (most - left_end) / 3};
  Mean veins[2];
  each_voxel(volume, shapes.vein, [&](Vec3 p) {
    for (int side = 0; side < 2; ++side)
      if (std::abs(p.x - thirds[side]) < slab_mm) veins[side].add(p);
  });
  double lung_voxels[2] = {0, 0};
  for (const int shape : {shapes.lung, shapes.pleura})
    if (shape != 0) each_voxel(volume, shape, [&](Vec3 p) { ++lung_voxels[f.side_of(p)]; });
  const Vec3 s = volume.voxels.spacing_mm;
  for (int side = 0; side < 2; ++side) {
    f.has_lung[side] = lung_voxels[side] * s.x * s.y * s.z >= 1000 * ChestFrame::min_lung_ml;
    f.has_vein[side] = veins[side].count > 0;
    if (f.has_vein[side]) f.vein_mm[side] = veins[side].value();
  }
  return f;
}

double ChestFrame::below_border_mm(Vec3 p) const {
  const auto after = border_z_mm.lower_bound(column_of(p.x));
  auto nearest = after == border_z_mm.end() ? std::prev(after) : after;
  if (after != border_z_mm.begin() && after != border_z_mm.end())
    if (const auto before = std::prev(after); column_of(p.x) - before->first < after->first - column_of(p.x))
      nearest = before;
  return nearest->second - p.z;
}

Vec3 ChestFrame::to_notch(Vec3 entry, Vec3 towards) const {
  const Vec3 line{notch_mm.x - entry.x, 0, notch_mm.z - entry.z}, way = normalized(Vec3{towards.x, 0, towards.z});
  return line - way * dot(line, way);
}

double ChestFrame::off_notch_deg(Vec3 entry, Vec3 towards) const {
  const Vec3 line = notch_mm - entry;
  const double a = std::hypot(line.x, line.z), b = std::hypot(towards.x, towards.z);
  if (!(a > 0) || !(b > 0)) return 90;  // straight into the chest
  return std::acos(std::clamp((line.x * towards.x + line.z * towards.z) / (a * b), -1.0, 1.0)) * 180 / M_PI;
}

}  // namespace trephine::lessons
