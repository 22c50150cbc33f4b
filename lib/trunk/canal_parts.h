// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"
#include "trunk/canal.h"

namespace trephine::trunk {

/// The middle of the canal in one slice, in continuous indices of the bone's lattice.
struct CanalPoint {
  double i = 0, j = 0;
};

/// The canal's course: one point for each slice from `first_slice` on. Empty where bone encloses nothing.
struct CanalCourse {
  int first_slice = 0;
  std::vector<CanalPoint> points;
};
CanalCourse canal_course(const mask::BitMask& bone, const CanalParams& params, const Progress& progress);

/// The wall as the distance from the course's point, in the slice, for each slice and `directions` angles.
struct CanalWall {
  static constexpr int directions = 72;
  std::vector<float> radius_mm;  ///< slice by slice
  std::vector<char> is_bone;     ///< measured, not interpolated
  double area_mm2(std::size_t slice) const;
  double walled_ratio(std::size_t slice) const;
  /// Interpolated between directions.
  double at(std::size_t slice, double angle) const;
};
/// Finds the wall and moves the course into its middle.
CanalWall canal_wall(const grid::Field& bone, CanalCourse& course, const CanalParams& params, const Progress& progress);

}  // namespace trephine::trunk
