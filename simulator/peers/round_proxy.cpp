// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers/round_proxy.h"

#include <algorithm>
#include <cmath>

#include "contact/constraints.h"
#include "surface/point_triangle.h"

namespace trephine::peers {
namespace {

// A way ends where the ball is nearly at the surface, and the tangent planes then hold it twice as far off: what it
// slides along is not met again.
constexpr double stops_mm = 5e-5, rests_mm = 1e-4;
constexpr double along_ratio = 1e-9;  // of the way: less than that towards the surface is rounding
constexpr double grazes_mm = 1e-7;    // a way that goes no deeper than this into what it passes is free of it

// When the moving point comes within the radius of `centre`; 2: never.
double sphere_time(Vec3 p, Vec3 way, double radius, Vec3 centre) {
  const Vec3 from = p - centre;
  const double a = dot(way, way), b = dot(from, way), c = dot(from, from) - radius * radius;
  const double root = b * b - a * c, least = radius - grazes_mm;
  if (!(a > 0) || !(b < 0) || !(dot(from, from) - b * b / a < least * least)) return 2;
  const double t = (-b - std::sqrt(root)) / a;
  return t >= 0 && t <= 1 ? t : 2;
}

// The same for the side between two corners.
double side_time(Vec3 p, Vec3 way, double radius, Vec3 from, Vec3 to) {
  const Vec3 along = to - from;
  const double length2 = dot(along, along);
  if (!(length2 > 0)) return sphere_time(p, way, radius, from);
  const Vec3 start = p - from;
  const Vec3 w = way - along * (dot(way, along) / length2), s = start - along * (dot(start, along) / length2);
  const double a = dot(w, w), b = dot(s, w), c = dot(s, s) - radius * radius;
  const double root = b * b - a * c, least = radius - grazes_mm;
  if (!(a > 0)) return std::min(sphere_time(p, way, radius, from), sphere_time(p, way, radius, to));
  if (!(dot(s, s) - b * b / a < least * least)) return 2;
  double best = 2;
  if (b < 0) {
    const double t = (-b - std::sqrt(root)) / a;
    const double at = dot(start + way * t, along) / length2;
    if (t >= 0 && t <= 1 && at >= 0 && at <= 1) best = t;
  }
  return std::min({best, sphere_time(p, way, radius, from), sphere_time(p, way, radius, to)});
}

// Whether the box comes so near to the way: the nearest points of both, found by turns, for each is convex.
bool is_within(const surface::FloatBox& box, Vec3 from, Vec3 to, double reach_mm) {
  const Vec3 way = to - from;
  const double length2 = dot(way, way);
  Vec3 on_way = from;
  for (int turn = 0; turn < 8; ++turn) {
    if (box.squared_distance(on_way) <= reach_mm * reach_mm) return true;
    if (!(length2 > 0)) break;
    Vec3 in_box;
    for (int a = 0; a < 3; ++a)
      in_box[a] = std::clamp(on_way[a], double(box.min[std::size_t(a)]), double(box.max[std::size_t(a)]));
    on_way = from + way * std::clamp(dot(in_box - from, way) / length2, 0.0, 1.0);
  }
  return false;
}

}  // namespace

double touch_time(Vec3 p, Vec3 way, double radius, Vec3 a, Vec3 b, Vec3 c, Vec3 normal) {
  const Vec3 off = p - surface::closest_on_triangle(p, a, b, c);
  const double distance = norm(off), length = norm(way);
  if (!(distance <= radius + length)) return 2;
  if (distance <= radius) return dot(off, way) < -along_ratio * distance * length ? 0 : 2;
  double best = 2;
  const double height = dot(normal, p - a), sinks = -dot(normal, way);
  if (height >= 0 && sinks > 0) {
    const double t = (height - radius) / sinks;
    if (t >= 0 && t <= 1) {
      const Vec3 foot = p + way * t;
      if (dot(cross(b - a, foot - a), normal) >= 0 && dot(cross(c - b, foot - b), normal) >= 0 &&
          dot(cross(a - c, foot - c), normal) >= 0)
        return t;
    }
  }
  best = std::min(best, side_time(p, way, radius, a, b));
  best = std::min(best, side_time(p, way, radius, b, c));
  return std::min(best, side_time(p, way, radius, c, a));
}

void RoundProxy::client(Vec3 device_mm) {
  const FeltMesh& mesh = *scene_.mesh;
  const Vec3 at = begun_ ? centre_ : device_mm - mesh.mesh().origin_mm;
  const Vec3 ahead = seen_ ? at + (at - seen_at_) * params_.look_ahead_ratio : at;
  seen_ = true;
  seen_at_ = at;
  const double reach = params_.local_set_mm + params_.proxy_radius_mm;
  const Vec3 around{reach, reach, reach};
  surface::FloatBox box;
  for (const Vec3 end : {at, ahead}) {
    box.add(end - around);
    box.add(end + around);
  }
  local_.clear();
  mesh.tree().for_each_leaf(box, 0, [&](std::size_t leaf) {
    const std::size_t end = std::min(surface::TriangleTree::width * (leaf + 1), mesh.tree().order().size());
    for (std::size_t n = surface::TriangleTree::width * leaf; n < end; ++n) {
      if (!is_within(mesh.tree().box(n), at, ahead, reach)) continue;
      const std::uint32_t t = mesh.tree().order()[n];
      local_.push_back({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2), mesh.normal(t)});
    }
  });
}

double RoundProxy::first_touch(Vec3 way) const {
  double first = 2;
  for (const Facet& f : local_)
    first = std::min(first, touch_time(centre_, way, params_.proxy_radius_mm + stops_mm, f.a, f.b, f.c, f.normal));
  return first;
}

// The tangent planes of what the ball touches and what is between it and the device: of the steepest three.
int RoundProxy::touched_planes(Vec3 device, contact::Plane* planes) const {
  const Vec3 towards = normalized(device - centre_);
  double steep[3] = {};
  int count = 0;
  for (const Facet& f : local_) {
    const Vec3 off = centre_ - surface::closest_on_triangle(centre_, f.a, f.b, f.c);
    const double distance = norm(off);
    if (!(distance <= params_.proxy_radius_mm + 1.5 * rests_mm) || !(distance > 0)) continue;
    const Vec3 normal = off / distance;
    const double against = -dot(normal, towards);
    if (!(against > 0)) continue;
    bool known = false;
    for (int n = 0; n < count; ++n) known = known || dot(planes[n].normal, normal) > 1 - 1e-9;
    if (known) continue;
    int at = count < 3 ? count++ : 3;
    if (at == 3)
      for (int n = 0; n < 3; ++n)
        if (steep[n] < against && (at == 3 || steep[n] < steep[at])) at = n;
    if (at == 3) continue;
    planes[at] = {centre_ + normal * (params_.proxy_radius_mm + rests_mm - distance), normal};
    steep[at] = against;
  }
  return count;
}

const haptics::HapticState& RoundProxy::update(const haptics::HapticInput& given) {
  const Vec3 origin = scene_.mesh->mesh().origin_mm, device = given.tip_mm - origin;
  if (!begun_) {
    centre_ = device;
    begun_ = true;
  }
  contact::Plane planes[3];
  int count = 0;
  Vec3 goal = device;
  for (int moves = 0; moves < 8; ++moves) {
    const Vec3 way = goal - centre_;
    const double t = first_touch(way);
    if (t > 1) {
      centre_ = goal;
      break;
    }
    centre_ += way * t;
    count = touched_planes(device, planes);
    contact::Nearest nearest;
    if (count == 0 || !contact::nearest_before(planes, count, device, nearest)) break;
    if (!(norm(nearest.point_mm - device) < norm(centre_ - device) - 1e-9)) break;  // no nearer
    goal = nearest.point_mm;
  }
  const bool held = norm(centre_ - device) > 1e-9;
  answer(state_, given, centre_ + origin, held, normalized(centre_ - device), scene_.shape, params_.spring_n_per_mm);
  return state_;
}

}  // namespace trephine::peers
