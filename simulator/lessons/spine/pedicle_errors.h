// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "lessons/spine/needle_watch.h"
#include "voxel/haptic_volume.h"

namespace trephine::lessons {

/// How far a needle lies from the ideal axis of a pedicle.
struct NeedleErrors {
  const CasePedicle* pedicle = nullptr;
  double entry_mm = 0;   ///< across the axis, where its line passes the plane of the ideal entry
  double target_mm = 0;  ///< the same at the target
  double depth_mm = 0;   ///< of the tip beyond the target along the axis; negative: short of it
  double turned_deg = 0;
  Vec3 entry_off, target_off;  ///< from the ideal place to where the line passes, mm
};
/// Of that pedicle.
NeedleErrors needle_errors(const CasePedicle& pedicle, Vec3 tip_mm, Vec3 axis);
/// Of the pedicle whose entry the needle's line passes nearest.
NeedleErrors nearest_pedicle(const std::vector<CasePedicle>& pedicles, Vec3 tip_mm, Vec3 axis);

/// Of the pedicle that was asked for; of the nearest where nothing was.
NeedleErrors errors_at(const std::vector<CasePedicle>& pedicles, const std::string& task, Vec3 tip_mm, Vec3 axis);

/// The farthest that a tip came beyond the target along the axis, in the passes at that pedicle, and when; far before
/// the target where there was none.
struct DeepestTip {
  double beyond_mm = -1e9, time_s = 0;
};
DeepestTip deepest_tip(const CasePedicle& pedicle, const std::vector<NeedlePass>& passes);

/// How far a needle came through the wall of a pedicle.
struct PedicleBreach {
  enum Wall { medial, lateral, upper, lower };
  double walls_mm[4] = {};  ///< beyond each wall
  double medial_mm = 0;     ///< the same of the wall towards the canal alone
  double other_mm = 0;      ///< and of the three others
  double other_s = 0;       ///< when it was that
  std::string other_side;
  double depth_mm = 0;  ///< of the needle's side beyond the wall; 0: none
  std::string side;     ///< "medial", "lateral", "upper" or "lower"
  Vec3 at_mm;
  double time_s = 0;
};
/// For each moment of the pass, and for the whole needle at its last one: the wall is where a straight line from the
/// ideal axis, across it, leaves the bone. Looked at from 4 mm past the entry on to the target, where the bone about
/// the axis is a pedicle or a body; farther than 40 mm off there is no wall.
PedicleBreach find_breach(const CasePedicle& pedicle, const NeedlePass& pass, const voxel::HapticVolume& volume,
                          int bone);

/// What lies in the pedicle by the grades of a screw [Gertzbein1990]: how far its side stands beyond a wall, with the
/// screw as it lies at the end of the pass. 0 (A): within; 1 (B): less than 2 mm; 2 (C): less than 4; 3 (D): less than
/// 6; 4 (E): 6 mm and more.
PedicleBreach breach_in_place(const CasePedicle& pedicle, const NeedlePass& pass, const voxel::HapticVolume& volume,
                              int bone);
int gertzbein_grade(const PedicleBreach& breach);

/// The narrowest width of the pedicle across its axis, between medial and lateral wall; 0 where it has none.
double pedicle_width_mm(const CasePedicle& pedicle, const voxel::HapticVolume& volume, int bone);

}  // namespace trephine::lessons
