// SPDX-License-Identifier: GPL-3.0-or-later
#include "drill/cutter_body.h"

#include <algorithm>
#include <cmath>

namespace trephine::drill {

CutterBody::CutterBody(const Cutter& c, const ToolPose& from, Vec3 to_tip_mm, double wider_mm, const grid::Lattice& l)
    : spacing_(l.spacing_mm), wider_(wider_mm), cylinder_(c.kind == Cutter::Kind::cylinder) {
  const auto along_lattice = [&](Vec3 v) { return transpose_times(l.direction, v); };
  const Vec3 axis = along_lattice(from.frame.column[2]);
  begin_ = along_lattice(from.tip_mm - l.origin_mm);
  way_ = along_lattice(to_tip_mm - from.tip_mm);
  way_squared_ = dot(way_, way_);
  ramp_ = std::max({spacing_.x, spacing_.y, spacing_.z});
  const double length = std::sqrt(way_squared_);
  if (!cylinder_) {
    begin_ += axis * c.radius_mm;
    radius_ = c.radius_mm + wider_;
    outer_ = radius_ + ramp_;
    middle_ = begin_ + way_ * 0.5;
    reach_ = outer_ + 0.5 * length;
    return;
  }
  for (std::size_t n = 0; n < 3; ++n) frame_.column[n] = along_lattice(from.frame.column[n]);
  semi_a_ = c.semi_a_mm + wider_;
  semi_b_ = c.semi_b_mm + wider_;
  height_ = c.height_mm;
  if (c.round_end) end_ = c.semi_a_mm;
  middle_ = begin_ + axis * (0.5 * height_) + way_ * 0.5;
  reach_ = std::hypot(0.5 * height_ + wider_ + ramp_, std::max(semi_a_, semi_b_) + ramp_) + 0.5 * length;
  const double step = 0.5 * std::min({spacing_.x, spacing_.y, spacing_.z});
  places_ = 1 + std::clamp(int(std::ceil(length / step)), 0, max_places - 1);
}

double CutterBody::voxel_across(Vec3 n) const {
  return std::sqrt(n.x * n.x * spacing_.x * spacing_.x + n.y * n.y * spacing_.y * spacing_.y +
                   n.z * n.z * spacing_.z * spacing_.z);
}

CutterBody::At CutterBody::at(Vec3 p) const { return cylinder_ ? cylinder_at(p) : ball_at(p); }

CutterBody::At CutterBody::ball_at(Vec3 p) const {
  Vec3 r = p - begin_;
  if (way_squared_ > 0) r = r - way_ * std::clamp(dot(r, way_) / way_squared_, 0.0, 1.0);
  const double squared = dot(r, r);
  if (!(squared < outer_ * outer_)) return {};
  const double distance = std::sqrt(squared);
  const double across = distance > 1e-9 ? voxel_across(r / distance) : ramp_;
  return {std::clamp(0.5 + (distance - radius_) / (2 * across), 0.0, 1.0), 1 - squared / (outer_ * outer_)};
}

CutterBody::At CutterBody::cylinder_at(Vec3 p) const {
  At best;
  const double a = semi_a_ + ramp_, b = semi_b_ + ramp_;
  for (int n = 0; n < places_; ++n) {
    const Vec3 q = transpose_times(frame_, p - begin_ - way_ * (places_ > 1 ? double(n) / (places_ - 1) : 1.0));
    if (q.z < end_) {  // within the reach of its round end
      const Vec3 r{q.x, q.y, q.z - end_};
      const double from = norm(r), out = from - semi_a_;
      if (out >= ramp_) continue;
      const double across = from > 1e-9 ? voxel_across(frame_ * (r / from)) : ramp_;
      const double stays = std::clamp(0.5 + out / (2 * across), 0.0, 1.0);
      if (stays < best.stays) best = {stays, std::max(1 - from * from / (a * a), 0.02)};
      continue;
    }
    const double out_of_height = std::max(-wider_ - q.z, q.z - height_ - wider_);
    if (out_of_height >= ramp_) continue;
    const double x = q.x / semi_a_, y = q.y / semi_b_, rho = std::hypot(x, y);
    // The distance from an ellipse, to first order.
    const Vec3 gradient{x / semi_a_, y / semi_b_, 0};
    const double slope = rho > 1e-9 ? norm(gradient) / rho : 1 / std::min(semi_a_, semi_b_);
    const double outside = (rho - 1) / slope;
    if (outside >= ramp_) continue;
    const double weight = 1 - (q.x * q.x) / (a * a) - (q.y * q.y) / (b * b);
    const bool at_end = out_of_height > outside;
    const Vec3 unit = at_end || rho < 1e-9 ? frame_.column[2] : normalized(frame_ * gradient);
    const double distance =
        outside > 0 && out_of_height > 0 ? std::hypot(outside, out_of_height) : std::max(outside, out_of_height);
    const double stays = std::clamp(0.5 + distance / (2 * voxel_across(unit)), 0.0, 1.0);
    if (stays < best.stays) best = {stays, std::max(weight, 0.02)};
  }
  return best;
}

}  // namespace trephine::drill
