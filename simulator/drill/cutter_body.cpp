// SPDX-License-Identifier: GPL-3.0-or-later
#include "drill/cutter_body.h"

#include <algorithm>
#include <cmath>

namespace trephine::drill {

namespace {

constexpr double around_voxels = 2;  // how far about a place a cutter is wider
// A ramp of the half width w about a hole of the radius r holds w^2 / (3 r^2) more than the hole: 1.6 % where it is
// 0.22 of the radius; but half a voxel is least, or the surface would be one of boxes.
constexpr double ramp_radii = 0.22, least_ramp_voxels = 0.5;

}  // namespace

double ramp_voxels(const Cutter& c, const grid::Lattice& l) {
  const double radius = c.kind == Cutter::Kind::cylinder ? c.semi_a_mm : c.radius_mm;
  const Vec3 s = l.spacing_mm;
  return std::clamp(ramp_radii * radius / std::max({s.x, s.y, s.z}), least_ramp_voxels, 1.0);
}

CutterBody::CutterBody(const Cutter& c, const ToolPose& from, Vec3 to_tip_mm, const Wider& wider,
                       const grid::Lattice& l)
    : spacing_(l.spacing_mm), wider_(wider), cylinder_(c.kind == Cutter::Kind::cylinder) {
  const auto along_lattice = [&](Vec3 v) { return transpose_times(l.direction, v); };
  const Vec3 axis = along_lattice(from.frame.column[2]);
  begin_ = along_lattice(from.tip_mm - l.origin_mm);
  way_ = along_lattice(to_tip_mm - from.tip_mm);
  way_squared_ = dot(way_, way_);
  for (int n = 0; n < wider_.places; ++n) wider_.at_mm[n] = along_lattice(wider_.at_mm[n] - l.origin_mm);
  ramp_ = std::max({spacing_.x, spacing_.y, spacing_.z});
  most_ = wider_.most_mm() + ramp_;
  steep_ = ramp_voxels(c, l);
  const double length = std::sqrt(way_squared_);
  if (!cylinder_) {
    begin_ += axis * c.radius_mm;
    radius_ = c.radius_mm;
    middle_ = begin_ + way_ * 0.5;
    reach_ = radius_ + most_ + 0.5 * length;
    return;
  }
  for (std::size_t n = 0; n < 3; ++n) frame_.column[n] = along_lattice(from.frame.column[n]);
  semi_a_ = c.semi_a_mm;
  semi_b_ = c.semi_b_mm;
  height_ = c.height_mm;
  if (c.round_end) end_ = c.semi_a_mm;
  middle_ = begin_ + axis * (0.5 * height_) + way_ * 0.5;
  reach_ = std::hypot(0.5 * height_ + most_, std::max(semi_a_, semi_b_) + most_) + 0.5 * length;
  const double step = 0.5 * std::min({spacing_.x, spacing_.y, spacing_.z});
  places_ = 1 + std::clamp(int(std::ceil(length / step)), 0, max_places - 1);
}

double CutterBody::voxel_across(Vec3 n) const {
  return steep_ * std::sqrt(n.x * n.x * spacing_.x * spacing_.x + n.y * n.y * spacing_.y * spacing_.y +
                            n.z * n.z * spacing_.z * spacing_.z);
}

double CutterBody::wider_at(Vec3 p) const {
  double most = 0;
  for (int n = 0; n < wider_.places; ++n) {
    const Vec3 d = p - wider_.at_mm[n];
    most = std::max(most, 1 - dot(d, d) / (around_voxels * around_voxels * ramp_ * ramp_));
  }
  return wider_.mm + most * std::max(0.0, wider_.held_mm - wider_.mm);
}

CutterBody::At CutterBody::at(Vec3 p) const {
  const double wider = wider_at(p);
  return cylinder_ ? cylinder_at(p, wider) : ball_at(p, wider);
}

CutterBody::At CutterBody::ball_at(Vec3 p, double wider) const {
  const double radius = radius_ + wider, outer = radius + ramp_;
  Vec3 r = p - begin_;
  if (way_squared_ > 0) r = r - way_ * std::clamp(dot(r, way_) / way_squared_, 0.0, 1.0);
  const double squared = dot(r, r);
  if (!(squared < outer * outer)) return {};
  const double distance = std::sqrt(squared);
  const double across = distance > 1e-9 ? voxel_across(r / distance) : ramp_;
  return {std::clamp(0.5 + (distance - radius) / (2 * across), 0.0, 1.0), 1 - squared / (outer * outer)};
}

CutterBody::At CutterBody::cylinder_at(Vec3 p, double wider) const {
  At best;
  const double semi_a = semi_a_ + wider, semi_b = semi_b_ + wider, a = semi_a + ramp_, b = semi_b + ramp_;
  for (int n = 0; n < places_; ++n) {
    const Vec3 q = transpose_times(frame_, p - begin_ - way_ * (places_ > 1 ? double(n) / (places_ - 1) : 1.0));
    if (q.z < end_) {  // within the reach of its round end
      const Vec3 r{q.x, q.y, q.z - end_};
      const double from = norm(r), out = from - semi_a;
      if (out >= ramp_) continue;
      const double across = from > 1e-9 ? voxel_across(frame_ * (r / from)) : ramp_;
      const double stays = std::clamp(0.5 + out / (2 * across), 0.0, 1.0);
      if (stays < best.stays) best = {stays, std::max(1 - from * from / (a * a), 0.02)};
      continue;
    }
    const double out_of_height = std::max(-wider - q.z, q.z - height_ - wider);
    if (out_of_height >= ramp_) continue;
    const double x = q.x / semi_a, y = q.y / semi_b, rho = std::hypot(x, y);
    // The distance from an ellipse, to first order.
    const Vec3 gradient{x / semi_a, y / semi_b, 0};
    const double slope = rho > 1e-9 ? norm(gradient) / rho : 1 / std::min(semi_a, semi_b);
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
