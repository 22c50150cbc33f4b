// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "cases/case.h"
#include "voxel/decode.h"
#include "voxel/haptic_volume.h"

namespace trephine::lessons {

/// A hole in the bone, LPS, mm.
struct BoneHole {
  Vec3 outer_mm, inner_mm;  ///< its middle at the outer and at the inner table
  Vec3 out{0, 0, 1};        ///< unit, out of the head
  double removed_mm3 = 0;   ///< 0: it was there beforehand
  double radius_mm = 0;     ///< of all that was removed, about its axis
  double begin_s = -1;      ///< when drilling began there, as HoleSite says
  bool drilled = false;     ///< in this session
  bool through = false;     ///< a ball as wide as the catheter passes
};

/// Where the drill ran, and how it was held there.
struct HoleSite {
  Vec3 at_mm, out;
  double begin_s = -1;
};

struct HoleSearch {
  int bone = 0;                 ///< the shape that was drilled
  double ball_mm = 2.5;         ///< diameter of what must pass
  grid::Box box;                ///< where something may have been removed; all of the volume where it is empty
  Vec3 out{0, 0, 1};            ///< about the direction out of the head
  std::vector<HoleSite> sites;  ///< the nearest says a hole's direction and begin; none: `out`
  std::optional<Vec3> near_mm;  ///< of several holes the nearest to this; else the largest
};

/// The hole that lies between the volume before and now: the voxels which were more than half bone and are no more,
/// joined by faces, edges or corners. Nothing where nothing was removed.
///
/// A ball passes where its middle gets from above the outer table to below the inner one over voxel centres that are at
/// least its radius from every voxel of bone: a hole that is up to a voxel wider than the ball may be called shut, none
/// that is narrower is called open.
std::optional<BoneHole> find_drilled_hole(const voxel::HapticVolume& before, const voxel::HapticVolume& now,
                                          const HoleSearch& search);

/// All of them, the largest first.
std::vector<BoneHole> find_drilled_holes(const voxel::HapticVolume& before, const voxel::HapticVolume& now,
                                         const HoleSearch& search);

/// The case's burr hole, drilled beforehand, that is nearest to the point.
std::optional<BoneHole> find_case_hole(const cases::CaseManifest& manifest, const std::optional<Vec3>& near_mm);

}  // namespace trephine::lessons
