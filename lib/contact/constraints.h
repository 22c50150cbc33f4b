// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/vec3.h"

namespace trephine::contact {

/// A tangent plane behind which a proxy may not go: dot(normal, x - point) >= 0.
struct Plane {
  Vec3 point_mm, normal;
};

/// The point nearest to `target` that lies behind none of up to three planes. The pressures say how far each plane
/// holds it off: nearest = target + sum of pressure_mm[i] * normal[i], none negative. Returns false where the planes
/// leave no such point, or are too nearly parallel.
struct Nearest {
  Vec3 point_mm;
  double pressure_mm[3] = {0, 0, 0};
};
bool nearest_before(const Plane* planes, int count, Vec3 target_mm, Nearest& out);

}  // namespace trephine::contact
