// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "base/vec3.h"

namespace trephine {

/// A rotation, then a shift, mm.
struct RigidMap {
  Mat3 turn;
  Vec3 offset_mm;
  Vec3 operator()(Vec3 p) const { return turn * p + offset_mm; }
};
/// first, then second.
RigidMap then(const RigidMap& first, const RigidMap& second);
RigidMap inverse(const RigidMap& map);
/// Three rows of four numbers: the rotation's, each with its part of the shift.
std::array<double, 12> rows_of(const RigidMap& map);
RigidMap map_of(const std::array<double, 12>& rows);
/// Whether the matrix is finite and a rotation to `off`: of unit, perpendicular columns, and not mirrored.
bool is_rotation(const Mat3& matrix, double off);

struct RigidFit {
  RigidMap map;
  double rms_mm = 0;  ///< of the distances that are left
};
/// The rotation and shift that bring `from` to `to`, point by point, with the least sum of squares [Horn1987]. Both
/// have the same number of points, at least three that lie on no line; a mirror image is never fitted.
RigidFit fit_rigid(const std::vector<Vec3>& from, const std::vector<Vec3>& to);

/// The expected error of a rigid fit at a place, from how far its points are off, rms: root mean square over many fits
/// [Fitzpatrick1998]. `points` are those that were fitted, in the frame of `at`. 1000 where fewer than three points, or
/// points on a line, are given.
double target_error_mm(const std::vector<Vec3>& points, double rms_mm, Vec3 at);

}  // namespace trephine
