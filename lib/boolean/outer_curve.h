// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The outline of a surface in a plane, and lengths along it.
#include "surface/arc.h"
#include "surface/trimesh.h"

namespace trephine::boolean::detail {

/// A sweep in a plane: rays from the centre, turning from `from` (unit) towards `onwards` (unit, perpendicular to it).
struct Sweep {
  Vec3 centre_mm, from, onwards;
  double before_deg = 5, after_deg = 175;  ///< how far to sweep on either side of `from`
};

/// The outermost point of the surface on each ray of the sweep, every 0.1 degrees: exact points where the plane cuts
/// the triangles. Rays that meet nothing are left out. `start` is the number of the first point at or after `from`.
using OuterCurve = surface::Arc;
OuterCurve outer_curve(const surface::TriMesh& mesh, const Sweep& sweep);

using trephine::surface::point_along;

}  // namespace trephine::boolean::detail
