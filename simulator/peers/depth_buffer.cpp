// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers/depth_buffer.h"

#include <algorithm>
#include <cmath>

#include "contact/constraints.h"

namespace trephine::peers {
namespace {

constexpr double resting_mm = 1e-6;  // above the landscape, against rounding
constexpr double camera_above_mm = 5;

}  // namespace

void DepthBuffer::reset() {
  begun_ = false;
  normal_ = {};
  picture_ = DepthPicture(params_.depth_pixels, params_.depth_side_mm);
}

void DepthBuffer::client(Vec3 device_mm) {
  const FeltMesh& mesh = *scene_.mesh;
  Vec3 middle = begun_ ? proxy_ : device_mm - mesh.mesh().origin_mm, towards = normal_;
  double above = camera_above_mm;
  if (towards == Vec3{}) {
    const auto near = mesh.nearest(middle, 0.5 * params_.depth_side_mm);
    if (!near) return;  // nothing to be seen; the picture before stays
    const Vec3 off = middle - near->point;
    towards =
        mesh.above(near->triangle, middle) > 0 && norm(off) > 1e-3 ? normalized(off) : mesh.normal(near->triangle);
    above = std::max(0.0, dot(off, towards)) + camera_above_mm;
    middle = near->point;
  }
  if (towards == Vec3{}) return;  // a facet without area
  picture_.draw(mesh, middle, towards, above);
  fresh_ = true;
}

// The first place of the way that is below the landscape, as a share of it; 2: none. Half a pixel a step.
double DepthBuffer::first_below(Vec3 from, Vec3 to) const {
  const Vec3 way = to - from;
  const double across = std::hypot(way.x, way.y);
  const int steps = std::max(1, int(std::ceil(2 * across / picture_.pixel_mm())));
  double before = 0;
  for (int n = 1; n <= steps; ++n) {
    double at = double(n) / steps;
    Vec3 p = from + way * at;
    if (p.z >= picture_.height(p.x, p.y)) {
      before = at;
      continue;
    }
    for (int halving = 0; halving < 30; ++halving) {
      const double middle = 0.5 * (before + at);
      p = from + way * middle;
      (p.z < picture_.height(p.x, p.y) ? at : before) = middle;
    }
    return before;
  }
  return 2;
}

const haptics::HapticState& DepthBuffer::update(const haptics::HapticInput& given) {
  const Vec3 origin = scene_.mesh->mesh().origin_mm, device = given.tip_mm - origin;
  if (!begun_) {
    proxy_ = device;
    begun_ = true;
  }
  normal_ = {};
  bool held = false;
  if (!picture_.drawn()) {
    proxy_ = device;
  } else {
    Vec3 at = picture_.to_picture(proxy_);
    const Vec3 aim = picture_.to_picture(device);
    const double deep = picture_.height(at.x, at.y) - at.z;
    // The new picture is that of a slightly other landscape.
    if (fresh_ && deep > -resting_mm && deep <= params_.depth_lift_mm) at.z += deep + resting_mm;
    fresh_ = false;
    if (at.z < picture_.height(at.x, at.y)) {
      at = aim;  // within the solid there is nothing to feel
    } else {
      contact::Plane planes[3];
      int count = 0;
      Vec3 goal = aim;
      for (int pass = 0; pass < 6; ++pass) {
        const double along = first_below(at, goal);
        if (along > 1) {
          at = goal;
          break;
        }
        at += (goal - at) * along;
        double slope_x, slope_y;
        const Vec3 below = at + normalized(goal - at) * 1e-6;
        picture_.height(below.x, below.y, &slope_x, &slope_y);
        const Vec3 normal = normalized({-slope_x, -slope_y, 1});
        at += normal * resting_mm;
        held = true;
        planes[count < 3 ? count++ : 2] = {at, normal};
        contact::Nearest nearest;
        if (!contact::nearest_before(planes, count, aim, nearest)) break;
        normal_ = normalized(nearest.point_mm - aim);
        if (!(norm(nearest.point_mm - aim) < norm(at - aim) - 1e-9)) break;  // no nearer
        goal = nearest.point_mm;
      }
    }
    proxy_ = picture_.from_picture(at);
    held = held && norm(at - aim) > 1e-9;
  }
  normal_ = held ? normalized(proxy_ - device) : Vec3{};
  answer(state_, given, proxy_ + origin, held, normal_, scene_.shape, params_.spring_n_per_mm);
  return state_;
}

}  // namespace trephine::peers
