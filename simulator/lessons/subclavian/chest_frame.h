// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <optional>
#include <string>

#include "cases/case.h"
#include "voxel/haptic_volume.h"

namespace trephine::lessons {

/// The shapes of a chest that the lesson knows, by number; 0 where there is none.
struct ChestShapes {
  int skin = 0, clavicle = 0, vein = 0, artery = 0, pleura = 0, lung = 0;
};
/// Throws Error 65 where the case has no skin, clavicle or vein to be felt: such a case holds no such lesson.
ChestShapes chest_shapes_of(const cases::CaseManifest& manifest);

/// What a central line is measured by, from the voxels of clavicles and veins. Points in LPS, mm; what is measured goes
/// by the body's own directions, however the patient lay in the scanner.
struct ChestFrame {
  Vec3 left{1, 0, 0},
      cranial{0, 0, 1};  ///< from the right clavicle's middle to the left one's; across it, in the frontal plane
  Vec3 notch_mm;         ///< the sternal notch: in the middle between the medial ends of the clavicles
  Vec3 clavicle_mm[2];   ///< the middle of that clavicle
  Vec3 vein_mm[2];       ///< a point of the vein (0: right, 1: left) under the medial third of that clavicle
  bool has_vein[2] = {false, false};
  bool has_lung[2] = {false, false};  ///< at least min_lung_ml of lung or pleura on that side of the notch
  std::map<int, double>
      border_mm;  ///< the clavicles' lower border along `cranial`, by steps of border_step_mm along `left`

  static constexpr double border_step_mm = 2, min_lung_ml = 20;
  int side_of(Vec3 p) const { return dot(p - notch_mm, left) > 0 ? 1 : 0; }
  /// How far the point lies below the lower border that is nearest to it along `left`; negative above it.
  double below_border_mm(Vec3 p) const;
  Vec3 in_frontal_plane(Vec3 way) const;
  /// From where the needle's line passes the notch to the notch, in the frontal plane, at right angles to the line.
  Vec3 to_notch(Vec3 entry_mm, Vec3 towards) const;
  /// Between the needle's way (to its tip) and the line from there to the notch, in the frontal plane.
  double off_notch_deg(Vec3 entry_mm, Vec3 towards) const;
};

/// Throws Error 65 where the clavicles are not two pieces beside each other.
ChestFrame chest_frame_of(const voxel::HapticVolume& volume, const ChestShapes& shapes);

}  // namespace trephine::lessons
