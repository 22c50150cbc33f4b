// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/subclavian/chest_frame.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "lessons/directions.h"
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

int column_of(double across_mm) { return int(std::floor(across_mm / ChestFrame::border_step_mm)); }

struct Mean {
  Vec3 sum;
  double count = 0;
  void add(Vec3 p) {
    sum += p;
    ++count;
  }
  Vec3 value() const { return sum / count; }
};

// Where the two clavicles end towards the middle, along the body's left.
struct Gap {
  double right_end = -1e9, left_end = 1e9;
  bool parts() const { return right_end > -1e9 && left_end < 1e9 && left_end - right_end >= min_gap_mm; }
};

// The patient's right is at smaller places. The gap that is nearest to the middle parts the two.
Gap gap_at(const std::map<int, double>& border_mm, double middle) {
  Gap gap;
  for (const auto& [column, up] : border_mm) {
    const double across = (column + 0.5) * ChestFrame::border_step_mm;
    if (across < middle) gap.right_end = std::max(gap.right_end, across);
    if (across > middle) gap.left_end = std::min(gap.left_end, across);
  }
  return gap;
}

// The body's left goes from the middle of what lies in the patient's right half to that of the other half: so a
// patient who lies askew is measured by his own frontal plane. Only how far he is bent forwards no clavicle tells.
void take_axes(const voxel::HapticVolume& volume, int clavicle, ChestFrame& f) {
  Mean all, halves[2];
  each_voxel(volume, clavicle, [&](Vec3 p) { all.add(p); });
  if (all.count == 0) return;
  const double middle = all.value().x;
  each_voxel(volume, clavicle, [&](Vec3 p) { halves[p.x > middle ? 1 : 0].add(p); });
  if (halves[0].count == 0 || halves[1].count == 0) return;
  const Vec3 left = halves[1].value() - halves[0].value();
  const BodyAxes axes = body_axes(true, left, cross(left, {0, 0, 1}));
  f.left = axes.lateral;
  f.cranial = axes.cranial;
}

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
  take_axes(volume, shapes.clavicle, f);
  double least = 1e9, most = -1e9;
  each_voxel(volume, shapes.clavicle, [&](Vec3 p) {
    const double across = dot(p, f.left), up = dot(p, f.cranial);
    least = std::min(least, across);
    most = std::max(most, across);
    double& border = f.border_mm.try_emplace(column_of(across), up).first->second;
    border = std::min(border, up);
  });
  const Gap gap = gap_at(f.border_mm, (least + most) / 2);
  if (!gap.parts())
    throw Error(ExitCode::bad_input, "", "haptic.shapes.clavicle",
                "is not two bones beside each other, between which the sternal notch would lie");
  Mean ends[2], bones[2];
  each_voxel(volume, shapes.clavicle, [&](Vec3 p) {
    const double across = dot(p, f.left);
    bones[across > (gap.right_end + gap.left_end) / 2 ? 1 : 0].add(p);
    if (across <= gap.right_end + 2 && across > gap.right_end - end_mm) ends[0].add(p);
    if (across >= gap.left_end - 2 && across < gap.left_end + end_mm) ends[1].add(p);
  });
  f.notch_mm = (ends[0].value() + ends[1].value()) / 2;
  for (int side = 0; side < 2; ++side) f.clavicle_mm[side] = bones[side].value();
  const double thirds[2] = {gap.right_end + (least - gap.right_end) / 3, gap.left_end + (most - gap.left_end) / 3};
  Mean veins[2];
  each_voxel(volume, shapes.vein, [&](Vec3 p) {
    for (int side = 0; side < 2; ++side)
      if (std::abs(dot(p, f.left) - thirds[side]) < slab_mm) veins[side].add(p);
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
  const int column = column_of(dot(p, left));
  const auto after = border_mm.lower_bound(column);
  auto nearest = after == border_mm.end() ? std::prev(after) : after;
  if (after != border_mm.begin() && after != border_mm.end())
    if (const auto before = std::prev(after); column - before->first < after->first - column) nearest = before;
  return nearest->second - dot(p, cranial);
}

Vec3 ChestFrame::in_frontal_plane(Vec3 way) const { return left * dot(way, left) + cranial * dot(way, cranial); }

Vec3 ChestFrame::to_notch(Vec3 entry, Vec3 towards) const {
  const Vec3 line = in_frontal_plane(notch_mm - entry), way = normalized(in_frontal_plane(towards));
  return line - way * dot(line, way);
}

double ChestFrame::off_notch_deg(Vec3 entry, Vec3 towards) const {
  const Vec3 line = in_frontal_plane(notch_mm - entry), way = in_frontal_plane(towards);
  const double a = norm(line), b = norm(way);
  if (!(a > 0) || !(b > 0)) return 90;  // straight into the chest
  return std::acos(std::clamp(dot(line, way) / (a * b), -1.0, 1.0)) * 180 / M_PI;
}

}  // namespace trephine::lessons
