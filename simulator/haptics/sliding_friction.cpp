// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/sliding_friction.h"

namespace trephine::haptics {
namespace {

constexpr double turned_back = 0.6;  // of the dynamic cone: roughness alone does not make a way that short
constexpr double rested_s = 0.05;    // without motion, until static friction holds a tool that slid

}  // namespace

// Whether the proxy moves along a surface: `length` is the way that is left, and the device is `depth` behind the
// surface. A proxy that slides goes on sliding: on an uneven surface the way may be a little shorter than the dynamic
// cone for a tick, which does not bring the static limit back. Only a device that turns back or rests does.
bool SlidingFriction::slides(const cases::CaseFace& feel, double length, double depth) {
  const double limit = feel.dynamic_friction_ratio * depth;
  if (!sliding_) {
    sliding_ = length > feel.static_friction_ratio * depth;
    if (sliding_) since_slid_s_ = 0;
    return sliding_ && length > limit;
  }
  if (length > limit) {
    since_slid_s_ = 0;
    return true;
  }
  sliding_ = length > turned_back * limit && since_slid_s_ < rested_s;
  return false;
}

bool SlidingFriction::slide(const HeldSurfaces& surfaces, int plane, Vec3 from, Vec3 device, Vec3& goal) {
  const HeldSurface& held = surfaces.surface(plane);
  const Vec3 way = surfaces.nearest_mm() - from;
  const double depth = norm(surfaces.nearest_mm() - device), ratio = held.feel.dynamic_friction_ratio;
  if (!held.grain.any()) {
    const double length = norm(way);
    if (!slides(held.feel, length, depth)) return false;
    goal = from + way * (1 - ratio * depth / length);
    return true;
  }
  // Beside other planes the way goes along an edge.
  const Vec3 normal = surfaces.presses_alone(plane) ? surfaces.plane(plane).normal : Vec3{};
  if (!slides(held.feel, held.grain.length_mm(way, normal), depth)) return false;
  goal = surfaces.nearest_mm() - held.grain.held_back_mm(way, normal, ratio * depth);
  return true;
}

}  // namespace trephine::haptics
