// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <vector>

#include "base/vec3.h"

namespace trephine::outcome {

/// A unit vector at right angles to a unit vector.
inline Vec3 perpendicular_to(Vec3 u) {
  return normalized(cross(u, std::abs(u.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
}

struct Frame {
  Vec3 u, a, b;  ///< along, and two across
  explicit Frame(Vec3 along) : u(normalized(along)) {
    a = perpendicular_to(u);
    b = cross(u, a);
  }
};

/// The straight line through points by least squares; from the first to the last.
struct Line {
  Vec3 at_mm, way;
  double off_mm = 0;  ///< the farthest point
};
Line line_through(const std::vector<Vec3>& points);

/// Of a component's voxels: its middle, direction, length and standard deviation across.
struct Rod {
  Line line;
  double length_mm = 0, across_mm = 0;
};
Rod rod_of(const std::vector<Vec3>& points);

}  // namespace trephine::outcome
