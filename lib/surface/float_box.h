// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/vec3.h"

namespace trephine::surface {

/// An axis-parallel box in float, of which the trees over triangles are made. It begins empty.
struct FloatBox {
  std::array<float, 3> min{3e38f, 3e38f, 3e38f}, max{-3e38f, -3e38f, -3e38f};
  /// The point is rounded outwards, so that the box holds it.
  void add(Vec3 p) {
    for (int a = 0; a < 3; ++a) {
      const float f = static_cast<float>(p[a]);
      min[a] = std::min(min[a], f <= p[a] ? f : std::nextafter(f, -std::numeric_limits<float>::infinity()));
      max[a] = std::max(max[a], f >= p[a] ? f : std::nextafter(f, std::numeric_limits<float>::infinity()));
    }
  }
  void add(const std::array<float, 3>& low, const std::array<float, 3>& high) {
    for (int a = 0; a < 3; ++a) {
      min[a] = std::min(min[a], low[a]);
      max[a] = std::max(max[a], high[a]);
    }
  }
  void add(const FloatBox& b) { add(b.min, b.max); }
  bool meets(const FloatBox& b) const {
    return min[0] <= b.max[0] && b.min[0] <= max[0] && min[1] <= b.max[1] && b.min[1] <= max[1] && min[2] <= b.max[2] &&
           b.min[2] <= max[2];
  }
  /// Half of its surface; 0 where it is empty.
  float half_area() const {
    const float x = max[0] - min[0], y = max[1] - min[1], z = max[2] - min[2];
    return x >= 0 ? x * y + y * z + z * x : 0;
  }
  /// Squared distance from the point to the box, 0 inside.
  double squared_distance(Vec3 p) const {
    double d2 = 0;
    for (int a = 0; a < 3; ++a) {
      const double d = std::max({min[a] - p[a], p[a] - max[a], 0.0});
      d2 += d * d;
    }
    return d2;
  }
};

}  // namespace trephine::surface
