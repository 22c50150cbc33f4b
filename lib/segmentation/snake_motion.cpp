// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/snake_motion.h"

#include <algorithm>
#include <cmath>

namespace trephine::segmentation {

/// Central differences of the speed, per mm. A wall is no edge that pulls: the speed goes on as it is before it.
SnakeMotion::Vec3f SnakeMotion::speed_slope(const int at[3], std::size_t v) const {
  Vec3f s{{0, 0, 0}};
  const float* g = g_.voxels.data() + v;
  if (*g <= snake_wall) return s;
  const auto beside = [&](std::ptrdiff_t to) { return g[to] > snake_wall ? g[to] : *g; };
  for (int a = 0; a < 3; ++a)
    s.v[a] =
        0.5f * s_.inv_h[a] * (beside(at[a] + 1 < l_.size[a] ? s_.step[a] : 0) - beside(at[a] > 0 ? -s_.step[a] : 0));
  return s;
}

/// How fast the surface next to voxel v is driven. The surface point is taken as the mean of the crossings along the
/// axes, by their nearness (on a plane it is the foot of the voxel's perpendicular), so that the voxels on both sides
/// of a crossing agree. `inwards` is the unit normal. Where the speed falls outwards, so that the surface comes to
/// rest, it is the mean over the step (the linearly implicit Euler step): no overshooting however steep the fall.
template <bool Advection>
float SnakeMotion::driven(const int at[3], std::size_t v, const float inwards[3]) const {
  const float* f = phi_.voxels.data() + v;
  const float* g = g_.voxels.data() + v;
  const float c = *f, inv_c = 1 / c;
  float sum = 0, total = 0, fall = 0;
  for (int a = 0; a < 3; ++a) {
    // One over the share of the way to the neighbour at which the crossing lies.
    float nearness = 0;
    std::ptrdiff_t to = 0;
    if (at[a] > 0 && (f[-s_.step[a]] > 0) != (c > 0)) {
      to = -s_.step[a];
      nearness = (c - f[to]) * inv_c;
    }
    if (at[a] + 1 < l_.size[a] && (f[s_.step[a]] > 0) != (c > 0)) {
      const float other = (c - f[s_.step[a]]) * inv_c;
      if (other > nearness) {
        to = s_.step[a];
        nearness = other;
      }
    }
    if (to == 0) continue;
    float here = weight_[0] * *g, there = weight_[0] * g[to];
    if (Advection) {
      int next[3] = {at[0], at[1], at[2]};
      next[a] += to > 0 ? 1 : -1;
      const Vec3f p = speed_slope(at, v), q = speed_slope(next, std::size_t(std::ptrdiff_t(v) + to));
      for (int b = 0; b < 3; ++b) {
        here += weight_[2] * inwards[b] * p.v[b];
        there += weight_[2] * inwards[b] * q.v[b];
      }
    }
    nearness = std::min(nearness, 1000.f);
    const float w = nearness * s_.inv_h2[a];
    sum += w * (nearness * here + there - here);
    fall += w * (c > 0 ? here - there : there - here);
    total += w * nearness;
  }
  if (!(total > 0)) return 0;
  const float steepness = std::sqrt(total);
  return sum / (total + longest_ * std::max(0.f, fall) * steepness);
}

template <bool Advection>
SnakeMotion::Rate SnakeMotion::rate_of(const int at[3], std::size_t v) const {
  const float* f = phi_.voxels.data() + v;
  std::ptrdiff_t lo[3], hi[3];
  float first[3], second[3];
  const float c = *f;
  float larger = 0, smaller = 0;
  for (int a = 0; a < 3; ++a) {
    lo[a] = at[a] > 0 ? -s_.step[a] : 0;
    hi[a] = at[a] + 1 < l_.size[a] ? s_.step[a] : 0;
    const float m = f[lo[a]], p = f[hi[a]];
    first[a] = 0.5f * s_.inv_h[a] * (p - m);
    second[a] = s_.inv_h2[a] * (p - 2 * c + m);
    const float up = std::max(0.f, std::max(m, p) - c) * s_.inv_h[a];
    const float down = std::max(0.f, c - std::min(m, p)) * s_.inv_h[a];
    larger += up * up;
    smaller += down * down;
  }
  const float length2 = first[0] * first[0] + first[1] * first[1] + first[2] * first[2] + 1e-6f;
  const float inv_length = 1 / std::sqrt(length2), inv_length2 = inv_length * inv_length;
  const float inwards[3] = {first[0] * inv_length, first[1] * inv_length, first[2] * inv_length};
  Rate m;
  m.hyperbolic = driven<Advection>(at, v, inwards);
  m.rate = m.hyperbolic * std::sqrt(m.hyperbolic > 0 ? larger : smaller);
  if (weight_[1] != 0) {
    const auto cross = [&](int a, int b) {
      return 0.25f * s_.inv_h[a] * s_.inv_h[b] *
             (f[hi[a] + hi[b]] - f[hi[a] + lo[b]] - f[lo[a] + hi[b]] + f[lo[a] + lo[b]]);
    };
    const float x = first[0], y = first[1], z = first[2];
    float bend = ((y * y + z * z) * second[0] + (x * x + z * z) * second[1] + (x * x + y * y) * second[2] -
                  2 * (x * y * cross(0, 1) + x * z * cross(0, 2) + y * z * cross(1, 2))) *
                 inv_length2;
    // No surface on the grid bends more than a voxel does.
    const float most = 2 * s_.inv_h[s_.finest] * length2 * inv_length;
    bend = std::max(-most, std::min(most, bend));
    // From the level set through the voxel to the surface, as if that were a ball.
    bend /= std::max(0.5f, std::min(2.f, 1 - 0.5f * c * bend * inv_length2));
    m.rate += weight_[1] * bend;
  }
  return m;
}

template SnakeMotion::Rate SnakeMotion::rate_of<false>(const int at[3], std::size_t v) const;
template SnakeMotion::Rate SnakeMotion::rate_of<true>(const int at[3], std::size_t v) const;

}  // namespace trephine::segmentation
