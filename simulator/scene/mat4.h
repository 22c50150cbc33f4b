// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "base/vec3.h"

namespace trephine::scene {

/// A 4 x 4 matrix as OpenGL takes it: column by column, float.
struct Mat4 {
  std::array<float, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  float& at(int row, int column) { return m[std::size_t(column * 4 + row)]; }
  float at(int row, int column) const { return m[std::size_t(column * 4 + row)]; }
};

inline Mat4 operator*(const Mat4& a, const Mat4& b) {
  Mat4 out;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) {
      float sum = 0;
      for (int k = 0; k < 4; ++k) sum += a.at(r, k) * b.at(k, c);
      out.at(r, c) = sum;
    }
  return out;
}

/// p becomes axes * p + offset.
inline Mat4 affine(const Mat3& axes, Vec3 offset) {
  Mat4 out;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) out.at(r, c) = float(axes.column[std::size_t(c)][r]);
    out.at(r, 3) = float(offset[r]);
  }
  return out;
}

}  // namespace trephine::scene
