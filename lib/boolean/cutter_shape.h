// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the sources of cutters share.
#include <array>

#include "boolean/cutter.h"

namespace trephine::boolean {

/// Cylinder and cone: the radius at the outer end (position_mm - above_mm * direction), and at the far end.
double start_radius_mm(const Cutter& cutter);
double far_radius_mm(const Cutter& cutter);

/// Columns: the first axis (an ellipsoid's `across`; else an arbitrary one that is always the same), the second, and
/// the direction.
Mat3 frame_of(const Cutter& cutter);

/// Ellipsoid, sphere: along frame_of's columns.
std::array<double, 3> semi_axes_mm(const Cutter& cutter);

/// mesh_of with the facets turned about the axis by that share of a facet (not for a mesh), and the whole mesh moved.
surface::TriMesh mesh_of(const Cutter& cutter, double max_deviation_mm, double turn_ratio, Vec3 shift_mm);

}  // namespace trephine::boolean
