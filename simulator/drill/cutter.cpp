// SPDX-License-Identifier: GPL-3.0-or-later
#include "drill/cutter.h"

#include <algorithm>
#include <cmath>

namespace trephine::drill {

CutterSweep::CutterSweep(const Cutter& c, const ToolPose& from, Vec3 to_tip_mm)
    : way_(to_tip_mm - from.tip_mm), frame_(from.frame), cylinder_(c.kind == Cutter::Kind::cylinder) {
  const Vec3 axis = from.frame.column[2];
  if (cylinder_) {
    begin_ = from.tip_mm;
    height_ = c.height_mm;
    per_mm_ = {1 / c.semi_a_mm, 1 / c.semi_b_mm, 1};
    const Vec3 d = transpose_times(frame_, way_);
    step_ = {d.x * per_mm_.x, d.y * per_mm_.y, d.z};
    step_squared_ = step_.x * step_.x + step_.y * step_.y;
    middle_ = begin_ + axis * (0.5 * height_) + way_ * 0.5;
    reach_ = std::hypot(0.5 * height_, std::max(c.semi_a_mm, c.semi_b_mm)) + 0.5 * norm(way_);
    return;
  }
  begin_ = from.tip_mm + axis * c.radius_mm;
  per_mm_ = Vec3{1, 1, 1} / c.radius_mm;
  step_ = way_ / c.radius_mm;
  step_squared_ = dot(step_, step_);
  middle_ = begin_ + way_ * 0.5;
  reach_ = c.radius_mm + 0.5 * norm(way_);
}

// With q the point and d the way, both scaled, |q - t d|^2 is below 1 between the roots of a quadratic; there the
// integral of 1 - |q - t d|^2 over t is a cubic.
double CutterSweep::dose(Vec3 point_mm) const {
  Vec3 q = point_mm - begin_;
  double t0 = 0, t1 = 1;
  if (cylinder_) {
    const Vec3 p = transpose_times(frame_, q);
    // z - t dz lies between 0 and the height.
    if (std::abs(step_.z) < 1e-12) {
      if (!(p.z >= 0 && p.z <= height_)) return 0;
    } else {
      const double u = p.z / step_.z, v = (p.z - height_) / step_.z;
      t0 = std::max(t0, std::min(u, v));
      t1 = std::min(t1, std::max(u, v));
    }
    q = {p.x * per_mm_.x, p.y * per_mm_.y, 0};
  } else {
    q = q * per_mm_.x;
  }
  const Vec3 d = cylinder_ ? Vec3{step_.x, step_.y, 0} : step_;
  const double outside = dot(q, q) - 1, along = dot(q, d);
  if (step_squared_ < 1e-18) return outside < 0 && t0 < t1 ? -outside * (t1 - t0) : 0;
  const double at_end = outside - 2 * along + step_squared_;
  if (!(outside <= 0 && at_end <= 0)) {  // the solid is left or entered on the way
    const double root = along * along - step_squared_ * outside;
    if (!(root > 0)) return 0;
    const double half = std::sqrt(root);
    t0 = std::max(t0, (along - half) / step_squared_);
    t1 = std::min(t1, (along + half) / step_squared_);
  }
  if (!(t0 < t1)) return 0;
  const double w =
      -outside * (t1 - t0) + along * (t1 * t1 - t0 * t0) - step_squared_ * (t1 * t1 * t1 - t0 * t0 * t0) / 3;
  return std::max(0.0, w);
}

}  // namespace trephine::drill
