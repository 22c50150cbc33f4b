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

/// The point `length_mm` along the arc from its start, measured as with dividers set to 2 mm, so that noise of the
/// surface does not lengthen it (an arc of radius 10 mm is 0.2 % short by that). None where the arc ends before.
std::optional<Vec3> point_along(const Arc& arc, double length_mm);

}  // namespace trephine
