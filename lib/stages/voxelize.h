// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "base/params.h"
#include "voxel/voxelize.h"

namespace trephine::stages {

/// What a scene says of one shape of its haptic volume.
struct HapticShapeParams {
  std::string clear_of;
  double clear_mm = 0, shell_mm = 0;
  std::array<double, 2> window_hu{0, 0};

  template <class V>
  static void describe(V& v) {
    using P = HapticShapeParams;
    v.text(&P::clear_of, "clear_of", "Another anatomy: this shape keeps clear_mm away from its surface.")
        .names("anatomy");
    v.number(&P::clear_mm, "clear_mm", Range{0.1, 100}, "How far the shape keeps away from clear_of.").none_at_zero();
    v.number(&P::shell_mm, "shell_mm", Range{0.1, 100},
             "Only what lies at most so deep below the surface belongs to the shape: a membrane, such as the dura.")
        .none_at_zero();
    v.numbers(&P::window_hu, "window_hu", Range{-32768, 32767},
              "With encoding hu: the shape is all voxels of the scan within these HU, both included.");
  }
  std::string fault() const;
};

/// A shape from which burr holes are cut. The hole in this shape can be wider all around, as skin is folded back from
/// the opening in the bone.
struct DrillParams {
  double widen_mm = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&DrillParams::widen_mm, "widen_mm", Range{0, 50},
             "How much wider all around than the hole this shape is cut.");
  }
};

/// Parameters of the whole haptic volume, without its shapes.
struct HapticVolumeParams : voxel::VoxelizeParams {
  voxel::HapticEncoding encoding = voxel::HapticEncoding::occupancy;
  std::string region_of;

  template <class V>
  static void describe(V& v) {
    using P = HapticVolumeParams;
    v.template all_of<voxel::VoxelizeParams>();
    v.choice(&P::encoding, "encoding",
             {{"occupancy", voxel::HapticEncoding::occupancy}, {"hu", voxel::HapticEncoding::hu}},
             "occupancy: each voxel says which shape fills it and how much of it; hu: the voxels are the scan's HU, "
             "and shapes are windows of HU.");
    v.text(&P::region_of, "region_of",
           "Anatomy whose box, with the margin, is the region; where empty, the box of all shapes.")
        .names("anatomy");
  }
};

/// Parameters of the stage voxelize.
struct VoxelizeStageParams : HapticVolumeParams {
  Named<HapticShapeParams> shapes;
  Named<DrillParams> drill;

  template <class V>
  static void describe(V& v) {
    using P = VoxelizeStageParams;
    v.template all_of<HapticVolumeParams>();
    v.map(&P::shapes, "shapes",
          "The shapes by name, in order of precedence: a part that one shape fills does not belong to later ones.")
        .at_most(voxel::haptic_max_shapes);
    v.map(&P::drill, "drill", "The shapes that the cutters cut.");
  }
};

}  // namespace trephine::stages
