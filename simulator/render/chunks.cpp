// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/chunks.h"

#include <cmath>

namespace trephine::render {

Sight sight_of(const scene::EyeView& eye, const scene::SceneState& state, Vec3 centre_mm) {
  Sight s;
  s.eye = eye.eye_mm - centre_mm;
  // A point at the distance z before the eye is within the frustum where left <= x / z <= right, and so on.
  const auto side = [&](Vec3 axis, double tangent, double sign) {
    const Vec3 normal = normalized((axis + eye.toward * tangent) * sign);
    s.planes.push_back({normal, dot(normal, s.eye)});
  };
  side(eye.right, eye.right_edge, 1);
  side(eye.right, eye.left, -1);
  side(eye.up, eye.top, 1);
  side(eye.up, eye.bottom, -1);
  if (state.cut) {
    const Vec3 normal = normalized(state.cut->normal);
    s.planes.push_back({normal, dot(normal, state.cut->point_mm - centre_mm)});
  }
  return s;
}

Sight sight_in(const Sight& sight, const Mat3& axes, Vec3 offset_mm) {
  Sight s = sight;
  s.eye = transpose_times(axes, sight.eye - offset_mm);
  s.near = transpose_times(axes, sight.near - offset_mm);
  for (Sight::Plane& p : s.planes) {
    p.offset -= dot(p.normal, offset_mm);
    p.normal = transpose_times(axes, p.normal);
  }
  return s;
}

void Chunk::include(const Chunk& other) {
  for (int k = 0; k < 3; ++k) {
    low[k] = std::min(low[k], other.low[k]);
    high[k] = std::max(high[k], other.high[k]);
  }
}

bool may_be_seen(const Chunk& chunk, const Sight& sight) {
  if (chunk.low.x > chunk.high.x) return false;
  for (const Sight::Plane& p : sight.planes) {
    double least = 0;
    for (int k = 0; k < 3; ++k) least += p.normal[k] * (p.normal[k] > 0 ? chunk.low[k] : chunk.high[k]);
    if (least > p.offset + 1e-3) return false;
  }
  return true;
}

double away_from_near(const Chunk& chunk, const Sight& sight) {
  Vec3 away;
  for (int k = 0; k < 3; ++k) away[k] = std::max({0.0, chunk.low[k] - sight.near[k], sight.near[k] - chunk.high[k]});
  return norm(away);
}

bool may_face(const Chunk& chunk, const Chunk::Range& range, const Sight& sight) {
  if (sight.faces == Sight::Faces::both || range.sine >= 1) return true;
  const Vec3 middle = (chunk.low + chunk.high) / 2 - sight.eye;
  const double reach = norm(chunk.high - chunk.low) / 2;
  const double along = dot(middle, range.axis) * (sight.faces == Sight::Faces::front ? 1 : -1);
  return along < range.sine * norm(middle) + reach;
}

}  // namespace trephine::render
