// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "phantom/head.h"

namespace trephine::phantom {

/// The landmarks of `Landmarks`, from the analytic surfaces.
Landmarks find_landmarks(const Head& head, const Model& model);

/// The skin's point `length_mm` from `start` along the curve in which the plane through `start` cuts the skin, setting
/// out towards `ahead`: steps of at most 0.25 mm, each put back onto the skin within the plane.
Vec3 walk_on_skin_mm(const Head& head, Vec3 start, Vec3 plane_normal, Vec3 ahead, double length_mm);

}  // namespace trephine::phantom
