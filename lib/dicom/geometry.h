// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <vector>

#include "dicom/import.h"
#include "grid/grid.h"

namespace trephine::dicom {

/// Steps that differ from a uniform step by at most this are uniform, and positions this near a slice belong to that
/// slice. Files give positions to 1 um.
constexpr double uniform_tolerance_mm = 1e-3;
/// An in-plane drift up to this across the whole stack comes from rounding of the orientation, not from tilt.
constexpr double drift_tolerance_mm = 0.02;
/// Slices nearer than this are at the same position.
constexpr double same_position_mm = 0.01;
constexpr int min_slices = 3;

/// What the parallel slices of a stack have in common, and where each slice's first voxel lies (patient LPS, mm).
struct SliceStack {
  int columns = 0, rows = 0;
  double dx_mm = 1, dy_mm = 1;
  Vec3 u{1, 0, 0}, v{0, 1, 0};  ///< orthonormal: direction of rising columns, and of rising rows
  std::vector<Vec3> positions_mm;
  Vec3 normal() const { return cross(u, v); }
};

/// Where the slices really lie, and the upright uniform grid that shows them.
struct StackGeometry {
  std::vector<std::vector<int>> levels;  ///< indices into positions_mm, ascending along the normal; several: duplicates
  std::vector<double> along_mm;          ///< for each level, along the normal; ascending
  std::vector<std::array<double, 2>>
      shift;  ///< per level: first voxel from the target's, in columns and rows of the target
  grid::Lattice target;
  double target_first_mm = 0;  ///< position of the target's first slice along the normal
  bool resampled = false;
  bool sheared = false;  ///< some shift is not 0
  std::string reason;    ///< why it is resampled: "tilt", "uneven spacing", "missing slices", joined by " and "
  double tilt_deg = 0;  ///< positive where the slices shift towards rising rows (columns) as they rise along the normal
  double smallest_step_mm = 0, largest_step_mm = 0;
  int missing_steps = 0;  ///< steps over missing slices, which are interpolated

  double target_mm(int k) const { return target_first_mm + k * target.spacing_mm.z; }
};

/// The median step along the normal between different positions; 0 for fewer than two. The positions may be in any
/// order.
double median_step_mm(const SliceStack& stack);
int count_levels(const SliceStack& stack);

/// Throws Error 65 where the stack is not a volume: fewer than three levels, a missing slice (unless it is
/// interpolated), a step above max_gap_mm, slices side by side, or positions that run at more than 45 degrees to the
/// normal.
StackGeometry analyse_stack(const SliceStack& stack, GapPolicy gaps, double max_gap_mm);

}  // namespace trephine::dicom
