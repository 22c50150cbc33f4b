// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>

#include "base/vec3.h"

namespace trephine::haptics {

/// The vector turned about a unit axis, right-handed (Rodrigues' formula).
inline Vec3 turned_about(Vec3 v, Vec3 unit, double rad) {
  const double c = std::cos(rad);
  return v * c + cross(unit, v) * std::sin(rad) + unit * (dot(unit, v) * (1 - c));
}

}  // namespace trephine::haptics
