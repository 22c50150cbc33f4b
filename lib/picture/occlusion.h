// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "picture/camera.h"

namespace trephine::picture::detail {

/// What the darkening of creases needs: the nearest opaque position (camera coordinates, mm) and normal of each pixel.
/// Of a row's pixels every fourth stands beside the other, so that the pixels of which the same neighbours are asked
/// are neighbours in memory.
struct SurfaceBuffer {
  static constexpr float nowhere_mm = 1e15f;  ///< where there is nothing; its square is still a float
  static constexpr int phases = 4;
  using Point = std::array<float, 3>;

  SurfaceBuffer() = default;
  SurfaceBuffer(int w, int h);
  std::size_t at(int x, int y) const { return (std::size_t(y) * phases + x % phases) * columns + x / phases; }
  void set(int x, int y, const Point& p, const Point& n) {
    const std::size_t i = at(x, y);
    for (int a = 0; a < 3; ++a) position[a][i] = p[a], normal[a][i] = n[a];
  }

  int width = 0, height = 0, columns = 0;  ///< columns of each phase
  std::array<std::vector<float>, 3> position, normal;
};

/// How much light reaches each pixel past its surroundings, from 0 to 1, row by row: screen-space obscurance
/// [McGuire2011] within radius_mm.
std::vector<float> openness(const SurfaceBuffer& buffer, const Camera& camera, double radius_mm);

}  // namespace trephine::picture::detail
