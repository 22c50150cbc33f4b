// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/occlusion.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace trephine::picture::detail {
namespace {

constexpr int sample_count = 16, turns = 7, tile = 4;

struct Offset {
  int x, y;  // pixels
};

// A spiral that is turned by another angle at each pixel of a 4 x 4 tile. The blur over such a tile removes the
// pattern.
std::vector<Offset> spirals(float radius_px) {
  constexpr double full = 6.283185307179586;
  std::vector<Offset> out;
  for (int cell = 0; cell < tile * tile; ++cell)
    for (int k = 0; k < sample_count; ++k) {
      const double radius = (k + 0.5) / sample_count;
      const double angle = full * (radius * turns + (cell * 7 % (tile * tile)) / double(tile * tile));
      const auto pixels = [&](double v) { return static_cast<int>(std::lround(float(v) * radius_px)); };
      out.push_back({pixels(radius * std::cos(angle)), pixels(radius * std::sin(angle))});
    }
  return out;
}

float hidden_at(const SurfaceBuffer& b, int x, int y, const Offset* offsets, float radius_mm) {
  const std::size_t at = std::size_t(y) * b.width + x;
  const auto &p = b.position[at], &n = b.normal[at];
  float sum = 0;
  for (int k = 0; k < sample_count; ++k) {
    const int i = x + offsets[k].x, j = y + offsets[k].y;
    if (i < 0 || j < 0 || i >= b.width || j >= b.height) continue;
    const std::size_t other = std::size_t(j) * b.width + i;
    const auto& q = b.position[other];
    const float v[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    const float along = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
    if (!(along > 0)) continue;  // nor where nothing is
    const float length2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    const float near = 1 - length2 / (radius_mm * radius_mm * 1.5f);
    if (!(near > 0) || !(length2 > 0)) continue;
    const float cosine = along / std::sqrt(length2);
    sum += std::max(0.f, cosine - 0.05f) * near;
  }
  return sum / sample_count;
}

}  // namespace

std::vector<float> openness(const SurfaceBuffer& b, const Camera& camera, double radius_mm) {
  std::vector<float> raw(b.covered.size(), 0.f), out(b.covered.size(), 1.f);
  const std::vector<Offset> offsets = spirals(static_cast<float>(radius_mm * camera.px_per_mm));
  parallel_for(0, b.height, 16, [&](std::int64_t from, std::int64_t to) {
    for (int y = static_cast<int>(from); y < to; ++y)
      for (int x = 0; x < b.width; ++x)
        if (b.covered[std::size_t(y) * b.width + x])
          raw[std::size_t(y) * b.width + x] = hidden_at(
              b, x, y, offsets.data() + (y % tile * tile + x % tile) * sample_count, static_cast<float>(radius_mm));
  });
  parallel_for(0, b.height, 16, [&](std::int64_t from, std::int64_t to) {
    for (int y = static_cast<int>(from); y < to; ++y)
      for (int x = 0; x < b.width; ++x) {
        const std::size_t at = std::size_t(y) * b.width + x;
        if (!b.covered[at]) continue;
        float sum = 0, weights = 0;
        for (int j = std::max(0, y - 2); j < std::min(b.height, y + 2); ++j)
          for (int i = std::max(0, x - 2); i < std::min(b.width, x + 2); ++i) {
            const std::size_t other = std::size_t(j) * b.width + i;
            if (!b.covered[other] || std::abs(b.position[other][2] - b.position[at][2]) > radius_mm / 4) continue;
            sum += raw[other];
            weights += 1;
          }
        const float hidden = weights > 0 ? sum / weights : raw[at];
        out[at] = 1 - std::min(0.85f, hidden * 6.0f);
      }
  });
  return out;
}

}  // namespace trephine::picture::detail
