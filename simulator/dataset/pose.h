// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cmath>

#include "base/vec3.h"

namespace trephine::dataset {

/// A place in metres and a rotation as a unit quaternion: x y z, qx qy qz qw. The rotation's columns are the object's
/// axes in the world, right-handed and of unit length.
inline std::array<double, 7> pose_of(Vec3 place_mm, const Mat3& axes) {
  const auto m = [&](std::size_t row, std::size_t column) { return axes.column[column][int(row)]; };
  std::array<double, 4> q{};  // x y z w
  const double trace = m(0, 0) + m(1, 1) + m(2, 2);
  // The largest of the four is found by a root, the others by division by it.
  std::size_t large = 3;
  double most = trace;
  for (std::size_t a = 0; a < 3; ++a)
    if (m(a, a) > most) {
      most = m(a, a);
      large = a;
    }
  if (large == 3) {
    q[3] = std::sqrt(1 + trace) / 2;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
      q[a] = (m(c, b) - m(b, c)) / (4 * q[3]);
    }
  } else {
    const std::size_t a = large, b = (a + 1) % 3, c = (a + 2) % 3;
    q[a] = std::sqrt(1 + m(a, a) - m(b, b) - m(c, c)) / 2;
    q[b] = (m(a, b) + m(b, a)) / (4 * q[a]);
    q[c] = (m(a, c) + m(c, a)) / (4 * q[a]);
    q[3] = (m(c, b) - m(b, c)) / (4 * q[a]);
  }
  return {place_mm.x / 1000, place_mm.y / 1000, place_mm.z / 1000, q[0], q[1], q[2], q[3]};
}

}  // namespace trephine::dataset
