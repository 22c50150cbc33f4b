// SPDX-License-Identifier: GPL-3.0-or-later
// The darkening of creases, against the formula computed pixel by pixel.
#include "picture/occlusion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/pi.h"
#include "random.h"

namespace trephine {
namespace {

using picture::detail::SurfaceBuffer;

constexpr double full_turn = 2 * pi;

// What the neighbours along the pixel's spiral hide of it, before it is averaged over its tile.
float hidden_at(const SurfaceBuffer& b, int x, int y, double radius_mm, double px_per_mm) {
  const int cell = y % 4 * 4 + x % 4;
  const std::size_t own = b.at(x, y);
  const auto radius = static_cast<float>(radius_mm);
  float sum = 0;
  for (int k = 0; k < 16; ++k) {
    const double share = (k + 0.5) / 16, angle = full_turn * (share * 7 + cell * 7 % 16 / 16.0);
    const auto pixels = [&](double v) {
      return static_cast<int>(std::lround(float(v) * static_cast<float>(radius_mm * px_per_mm)));
    };
    const int i = x + pixels(share * std::cos(angle)), j = y + pixels(share * std::sin(angle));
    if (i < 0 || j < 0 || i >= b.width || j >= b.height) continue;
    float along = 0, length2 = 0;
    for (int a = 0; a < 3; ++a) {
      const float d = b.position[a][b.at(i, j)] - b.position[a][own];
      along += d * b.normal[a][own];
      length2 += d * d;
    }
    if (!(along > 0)) continue;
    const float near = 1 - length2 / (radius * radius * 1.5f);
    if (near > 0) sum += std::max(0.f, along / std::sqrt(length2) - 0.05f) * near;
  }
  return sum / 16;
}

float open_at(const SurfaceBuffer& b, int x, int y, double radius_mm, double px_per_mm) {
  float sum = 0, weights = 0;
  for (int j = std::max(0, y - 2); j < std::min(b.height, y + 2); ++j)
    for (int i = std::max(0, x - 2); i < std::min(b.width, x + 2); ++i) {
      if (std::abs(b.position[2][b.at(i, j)] - b.position[2][b.at(x, y)]) > radius_mm / 4) continue;
      sum += hidden_at(b, i, j, radius_mm, px_per_mm);
      weights += 1;
    }
  return 1 - std::min(0.85f, sum / weights * 6);
}

TEST(Occlusion, IsThatOfTheFormula) {
  constexpr double px_per_mm = 2, radius_mm = 6;
  picture::detail::Camera camera;
  camera.px_per_mm = px_per_mm;
  Random random(5);
  SurfaceBuffer b(53, 41);  // rows that do not end with a tile
  const auto is_there = [](int x, int y) { return (x - 20) * (x - 20) + (y - 25) * (y - 25) > 40 && x > 6; };
  for (int y = 0; y < b.height; ++y)
    for (int x = 0; x < b.width; ++x) {
      if (!is_there(x, y)) continue;
      const float slope = x < 30 ? 0.8f : -0.2f;  // a crease at 30, and bumps
      const auto z = static_cast<float>(0.8 * std::abs(x - 30) / px_per_mm + random(0, 1.2));
      const float length = std::sqrt(1 + slope * slope);
      b.set(x, y, {float(x / px_per_mm), float(-y / px_per_mm), z}, {slope / length, 0.f, 1 / length});
    }
  const std::vector<float> open = picture::detail::openness(b, camera, radius_mm);
  double darkest = 1;
  for (int y = 0; y < b.height; ++y)
    for (int x = 0; x < b.width; ++x) {
      const float got = open[std::size_t(y) * b.width + x];
      ASSERT_NEAR(got, is_there(x, y) ? open_at(b, x, y, radius_mm, px_per_mm) : 1.f, 1e-5) << x << " " << y;
      darkest = std::min(darkest, double(got));
    }
  EXPECT_LT(darkest, 0.5);
}

}  // namespace
}  // namespace trephine
