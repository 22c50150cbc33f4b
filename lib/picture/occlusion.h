// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "picture/camera.h"

namespace trephine::picture::detail {

/// What the darkening of creases needs: the nearest opaque position (camera coordinates, mm) and normal of each pixel;
/// NaN where there is none.
struct SurfaceBuffer {
  int width = 0, height = 0;
  std::vector<std::array<float, 3>> position, normal;
  std::vector<std::uint8_t> covered;
};

/// How much light reaches each pixel past its surroundings, from 0 to 1: screen-space obscurance [McGuire2011] within
/// radius_mm.
std::vector<float> openness(const SurfaceBuffer& buffer, const Camera& camera, double radius_mm);

}  // namespace trephine::picture::detail
