// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The outline of a surface in a plane, and lengths along it.
#include <optional>
#include <vector>

#include "surface/trimesh.h"

namespace trephine::detail {

/// A sweep in a plane: rays from the centre, turning from `from` (unit) towards `onwards` (unit, perpendicular to it).
struct Sweep {
  Vec3 centre_mm, from, onwards;
  double before_deg = 5, after_deg = 175;  ///< how far to sweep on either side of `from`
};

/// The outermost point of the surface on each ray of the sweep, every 0.1 degrees; exact points of the triangles' cut
/// with the plane. Rays that meet nothing are left out. `start` is the number of the first point at or after `from`.
struct OuterCurve {
  std::vector<Vec3> points_mm;
  std::size_t start = 0;
};
OuterCurve outer_curve(const TriMesh& mesh, const Sweep& sweep);

/// The point `length_mm` along the curve from its start, measured as with dividers set to 2 mm, so that noise of the
/// surface does not lengthen it (an arc of radius 10 mm is 0.2 % short by that). None where the curve ends before.
std::optional<Vec3> point_along(const OuterCurve& curve, double length_mm);

}  // namespace trephine::detail
