// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers/tangent_plane.h"

#include <algorithm>

namespace trephine::peers {

void TangentPlane::reset() {
  begun_ = has_plane_ = false;
  recovers_mm_ = since_s_ = 0;
}

// How deep the device counts as being behind the plane.
double TangentPlane::depth(Vec3 device) const {
  if (!has_plane_) return 0;
  const double left = since_s_ < params_.recovery_s ? 1 - since_s_ / params_.recovery_s : 0;
  return std::max(0.0, dot(plane_.normal, plane_.point_mm - device) - recovers_mm_ * left);
}

void TangentPlane::client(Vec3 device_mm) {
  const FeltMesh& mesh = *scene_.mesh;
  const Vec3 device = device_mm - mesh.mesh().origin_mm;
  const Vec3 from = begun_ ? proxy_ : device;
  const double felt_mm = depth(device);
  const auto near = mesh.nearest(from, params_.plane_reach_mm);
  has_plane_ = near.has_value();
  if (!near) return;
  // Beside an edge the way from the nearest point says where the surface faces; on a facet the facet does.
  const Vec3 off = from - near->point;
  const Vec3 facet = mesh.normal(near->triangle);
  const bool outside = dot(off, facet) >= 0;
  const Vec3 normal = norm(off) > 1e-6 ? normalized(outside ? off : -off) : facet;
  plane_ = {near->point, normal};
  recovers_mm_ = std::max(0.0, dot(normal, near->point - device)) - felt_mm;
  since_s_ = 0;
}

const haptics::HapticState& TangentPlane::update(const haptics::HapticInput& given) {
  const Vec3 origin = scene_.mesh->mesh().origin_mm, device = given.tip_mm - origin;
  begun_ = true;
  const double deep = depth(device);
  since_s_ += given.dt_s;
  proxy_ = device + (has_plane_ ? plane_.normal * deep : Vec3{});
  answer(state_, given, proxy_ + origin, deep > 0, deep > 0 ? plane_.normal : Vec3{}, scene_.shape,
         params_.spring_n_per_mm);
  return state_;
}

}  // namespace trephine::peers
