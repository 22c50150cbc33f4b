// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/held_surfaces.h"

#include <algorithm>

#include "touch/mesh_surfaces.h"

namespace trephine::haptics {

void HeldSurfaces::clear() {
  count_ = 0;
  solved_ = false;
}

bool HeldSurfaces::is_same(int place, Vec3 normal, int shape) const {
  const bool facet = touch::is_mesh(shape) || touch::is_mesh(held_[place].shape);
  return dot(planes_[place].normal, normal) > (facet ? same_facet : same_surface);
}

bool HeldSurfaces::knows(Vec3 normal, int shape) const { return place_of(normal, shape) < count_; }

int HeldSurfaces::place_of(Vec3 normal, int shape) const {
  int at = count_;
  for (int n = 0; n < count_; ++n)
    if (is_same(n, normal, shape)) at = n;
  return at;
}

void HeldSurfaces::set(int place, const contact::Plane& plane, const HeldSurface& surface) {
  planes_[place] = plane;
  held_[place] = surface;
  count_ = std::max(count_, place + 1);
}

int HeldSurfaces::put(const contact::Plane& plane, const HeldSurface& surface) {
  int at = count_ < max_count ? count_ : -1;
  for (int n = 0; n < count_ && count_ == max_count; ++n)
    if (solved_ && nearest_.pressure_mm[n] == 0) at = n;
  contact::Plane put = plane;
  for (int n = 0; n < count_; ++n)
    if (is_same(n, plane.normal, surface.shape)) {
      at = n;
      if (dot(plane.normal, planes_[n].point_mm - plane.point_mm) > 0) put.point_mm = planes_[n].point_mm;
    }
  if (at >= 0) set(at, put, surface);
  return at;
}

bool HeldSurfaces::solve(Vec3 device) {
  solved_ = contact::nearest_before(planes_, count_, device, nearest_);
  return solved_;
}

bool HeldSurfaces::presses_alone(int place) const {
  for (int n = 0; n < count_; ++n)
    if (n != place && nearest_.pressure_mm[n] > 0) return false;
  return true;
}

bool HeldSurfaces::any_presses() const {
  for (int n = 0; n < count_; ++n)
    if (nearest_.pressure_mm[n] > 0) return true;
  return false;
}

// The springs of a shape, along the normals and along the way that friction holds, relax as one.
void HeldSurfaces::relax(Vec3 slid, double pressure, double* push, tissue::Relaxations& relaxing) const {
  std::uint64_t seen = 0;
  for (int n = 0; n < count_; ++n) {
    const int shape = held_[n].shape;
    if (!(push[n] > 0) || !relaxing.relaxes(shape) || (seen >> shape & 1)) continue;
    seen |= std::uint64_t{1} << shape;
    Vec3 whole;
    for (int m = n; m < count_; ++m)
      if (held_[m].shape == shape) whole += planes_[m].normal * push[m] + slid * (push[m] / pressure);
    const double share = relaxing.share(shape, norm(whole));
    relaxing.note(shape, norm(whole));
    for (int m = n; m < count_; ++m)
      if (held_[m].shape == shape) push[m] *= share;
  }
}

HeldSurfaces::Felt HeldSurfaces::felt(Vec3 proxy, Vec3 device, Vec3 velocity, int named,
                                      tissue::Relaxations& relaxing) const {
  Felt is;
  if (count_ == 0) return is;
  if (!solved_) {
    const HeldSurface& h = held_[count_ - 1];
    is.shape = h.shape;
    is.face = h.face;
    is.count = count_;
    is.normal = planes_[count_ - 1].normal;
    is.force_n = (proxy - device) * h.feel.stiffness_n_per_mm;
    const double whole = norm(is.force_n);
    is.force_n = is.force_n * relaxing.share(h.shape, whole);
    relaxing.note(h.shape, whole);
    is.torque_n_mm = cross(h.arm_mm, is.force_n);
    return is;
  }
  Vec3 arm;
  double most = -1, pressure = 0, spring = 0, pushes[max_count] = {};
  for (int n = 0; n < count_; ++n) {
    const double mm = nearest_.pressure_mm[n];
    if (!(mm > 0)) continue;
    ++is.count;
    pressure += mm;
    pushes[n] = held_[n].feel.stiffness_n_per_mm * mm;
  }
  if (pressure > 0) relax(proxy - nearest_.point_mm, pressure, pushes, relaxing);
  for (int n = 0; n < count_; ++n) {
    const cases::CaseFace& feel = held_[n].feel;
    const double mm = nearest_.pressure_mm[n], push = pushes[n];
    if (!(mm > 0)) continue;
    spring += push;
    const Vec3 back =
        planes_[n].normal * std::max(0.0, push - feel.damping_n_s_per_mm * dot(velocity, planes_[n].normal));
    is.force_n += back;
    is.torque_n_mm += cross(held_[n].arm_mm, back);
    arm += held_[n].arm_mm * mm;
    const double counts = held_[n].shape == named ? 1.25 * push : push;
    if (counts > most) {
      most = counts;
      is.shape = held_[n].shape;
      is.face = held_[n].face;
      is.normal = planes_[n].normal;
    }
  }
  if (!(pressure > 0)) return is;
  const Vec3 friction = (proxy - nearest_.point_mm) * (spring / pressure);
  is.torque_n_mm += cross(arm / pressure, friction);
  is.force_n = is.force_n + friction;
  return is;
}

}  // namespace trephine::haptics
