// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "base/vec3.h"

namespace trephine::surface {

/// An outline of a body in a plane, point by point, and the number of the point from which lengths are measured.
struct Arc {
  std::vector<Vec3> points_mm;
  std::size_t start = 0;
};

/// The point `length_mm` along the arc from its start, measured in steps of 2 mm as with a pair of dividers, so that
/// noise of the surface does not lengthen it (an arc of radius 10 mm is measured 0.2 % short). None where the arc ends
/// before.
std::optional<Vec3> point_along(const Arc& arc, double length_mm);

constexpr double brow_mm = 40;  ///< from the nasion over the brow to the even forehead

/// The arc without what stands out from it over less than `width_mm`: strands of a mask that were left on the skin,
/// which would lengthen a way that is measured over them. What stands out by less than `least_mm` stays as it is. The
/// points must be those of rays from `centre_mm`, in their order. The first `spared_mm` from the arc's start stay as
/// they are: behind the nasion they hold the brow, which is a ridge of the head's own. The rest of a head's own outline
/// does not change.
Arc without_ridges(const Arc& arc, Vec3 centre_mm, double spared_mm, double width_mm = 12, double least_mm = 0.7);

}  // namespace trephine::surface
