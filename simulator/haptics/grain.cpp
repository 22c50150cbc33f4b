// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/grain.h"

#include <algorithm>
#include <cmath>

#include "haptics/tool.h"

namespace trephine::haptics {

Grain::Grain(const cases::MaterialParams& material, const cases::CaseFace& face) {
  if (face.across_grain_ratio == 1) return;
  any_ = true;
  const Vec3 along = normalized(material.grain_direction);
  const double across = 1 / (face.across_grain_ratio * face.across_grain_ratio);
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      squared_.column[std::size_t(c)][r] = (r == c ? across : 0) + (1 - across) * along[r] * along[c];
}

Grain Grain::mixed(const Grain& other, double share) const {
  if (!any_ && !other.any_) return *this;
  Grain mixed;
  mixed.any_ = true;
  for (std::size_t c = 0; c < 3; ++c)
    mixed.squared_.column[c] = squared_.column[c] * (1 - share) + other.squared_.column[c] * share;
  return mixed;
}

double Grain::length_mm(Vec3 way, Vec3 normal) const {
  const double off = dot(way, normal);  // a surface's own roughness; it counts as it is
  const Vec3 within = way - normal * off;
  return std::sqrt(product(within, within) + off * off);
}

Vec3 Grain::held_back_mm(Vec3 way, Vec3 normal, double limit) const {
  const double size = length_mm(way, normal);
  if (!(limit > 0)) return {};
  if (normal == Vec3{} || !(size > limit)) return size > limit ? way * (limit / size) : way;
  // The ellipse's axes in the surface.
  const Mat3 frame = frame_along(normal);
  const Vec3 e = frame.column[0], f = frame.column[1];
  const double turn = 0.5 * std::atan2(2 * product(e, f), product(e, e) - product(f, f));
  const Vec3 axes[3] = {e * std::cos(turn) + f * std::sin(turn), f * std::cos(turn) - e * std::sin(turn), normal};
  const double weights[3] = {product(axes[0], axes[0]), product(axes[1], axes[1]), 1};
  // The place is way / (1 + lambda weight) along each axis; lambda makes it as long as the limit. Newton's steps on
  // one over that length begin at a lambda that is too small, and never go beyond the solution.
  double lambda = (size / limit - 1) / std::max({weights[0], weights[1], weights[2]});
  double along[3], length = 0;
  for (int n = 0; n < 30; ++n) {
    double squared = 0, slope = 0;
    for (int a = 0; a < 3; ++a) {
      const double shrinks = 1 + lambda * weights[a];
      along[a] = dot(way, axes[a]) / shrinks;
      squared += weights[a] * along[a] * along[a];
      slope += weights[a] * weights[a] * along[a] * along[a] / shrinks;
    }
    length = std::sqrt(squared);
    if (!(length > limit * (1 + 1e-12))) break;
    lambda += (length / limit - 1) * squared / slope;
  }
  return (axes[0] * along[0] + axes[1] * along[1] + axes[2] * along[2]) * (limit / length);
}

}  // namespace trephine::haptics
