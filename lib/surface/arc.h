// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "base/vec3.h"

namespace trephine {

/// An outline of a body in a plane, point by point, and the number of the point from which lengths are measured.
struct Arc {
  std::vector<Vec3> points_mm;
  std::size_t start = 0;
};

/// The point `length_mm` along the arc from its start, measured in steps of 2 mm as with a pair of dividers, so that
/// noise of the surface does not lengthen it (an arc of radius 10 mm is measured 0.2 % short). None where the arc ends
/// before.
std::optional<Vec3> point_along(const Arc& arc, double length_mm);

}  // namespace trephine
