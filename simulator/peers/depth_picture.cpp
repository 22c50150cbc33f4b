// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers/depth_picture.h"

#include <algorithm>
#include <cmath>

#include "haptics/tool.h"

namespace trephine::peers {

DepthPicture::DepthPicture(int pixels, double side_mm)
    : pixels_(pixels), side_mm_(side_mm), heights_(std::size_t(pixels) * std::size_t(pixels), nothing) {}

void DepthPicture::draw(const FeltMesh& mesh, Vec3 middle, Vec3 towards, double above_mm) {
  middle_ = middle;
  axes_ = haptics::frame_along(towards);
  std::fill(heights_.begin(), heights_.end(), nothing);
  // Of all corners, then of all triangles, as a graphics card does it.
  const surface::TriMesh& m = mesh.mesh();
  corners_.resize(m.points_mm.size());
  const double scale = pixels_ / side_mm_, half = 0.5 * pixels_ - 0.5;
  for (std::size_t n = 0; n < corners_.size(); ++n) {
    const Vec3 p = to_picture(m.points_mm[n]);
    corners_[n] = {float(p.x * scale + half), float(p.y * scale + half), float(p.z)};
  }
  const float end = float(pixels_ - 1), top = float(above_mm), bottom = float(-0.5 * side_mm_);
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const auto& a = corners_[m.triangles[t][0]];
    const auto& b = corners_[m.triangles[t][1]];
    const auto& c = corners_[m.triangles[t][2]];
    const float low_x = std::min({a[0], b[0], c[0]}), high_x = std::max({a[0], b[0], c[0]});
    const float low_y = std::min({a[1], b[1], c[1]}), high_y = std::max({a[1], b[1], c[1]});
    if (!(high_x >= 0 && low_x <= end && high_y >= 0 && low_y <= end)) continue;
    if (std::max({a[2], b[2], c[2]}) < bottom || std::min({a[2], b[2], c[2]}) > top) continue;
    const float area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (area == 0) continue;
    const int first_x = int(std::ceil(std::max(0.0f, low_x))), last_x = int(std::floor(std::min(end, high_x)));
    const int first_y = int(std::ceil(std::max(0.0f, low_y))), last_y = int(std::floor(std::min(end, high_y)));
    for (int y = first_y; y <= last_y; ++y)
      for (int x = first_x; x <= last_x; ++x) {
        const float at_x = float(x), at_y = float(y);
        const float u = ((b[0] - at_x) * (c[1] - at_y) - (b[1] - at_y) * (c[0] - at_x)) / area;
        const float v = ((c[0] - at_x) * (a[1] - at_y) - (c[1] - at_y) * (a[0] - at_x)) / area;
        const float w = 1 - u - v;
        if (!(u >= 0 && v >= 0 && w >= -1e-6f)) continue;
        const float z = u * a[2] + v * b[2] + w * c[2];
        float& height = heights_[std::size_t(y) * std::size_t(pixels_) + std::size_t(x)];
        if (z > height && z <= top && z >= bottom) height = z;
      }
  }
  drawn_ = true;
}

double DepthPicture::height(double x_mm, double y_mm, double* slope_x, double* slope_y) const {
  const double scale = pixels_ / side_mm_, half = 0.5 * pixels_ - 0.5;
  const double x = x_mm * scale + half, y = y_mm * scale + half;
  if (slope_x) *slope_x = *slope_y = 0;
  if (!(x >= 0 && y >= 0 && x < pixels_ - 1 && y < pixels_ - 1)) return nothing;
  const int i = int(x), j = int(y);
  const double u = x - i, v = y - j;
  const float* row = heights_.data() + std::size_t(j) * std::size_t(pixels_) + std::size_t(i);
  const float* next = row + pixels_;
  if (row[0] == nothing || row[1] == nothing || next[0] == nothing || next[1] == nothing) return nothing;
  const double low = row[0] + u * (row[1] - row[0]), high = next[0] + u * (next[1] - next[0]);
  if (slope_x) {
    *slope_x = ((1 - v) * (row[1] - row[0]) + v * (next[1] - next[0])) * scale;
    *slope_y = (high - low) * scale;
  }
  return low + v * (high - low);
}

}  // namespace trephine::peers
