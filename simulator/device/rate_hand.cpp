// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/rate_hand.h"

#include <algorithm>
#include <cmath>

#include "touch/frames.h"

namespace trephine::device {
namespace {

constexpr double above_mm = 20;  // of the volume's middle in which something is felt
constexpr double spring_damping = 0.006;

Vec3 turned_by(Vec3 v, Vec3 rad) {
  const double angle = norm(rad);
  return angle > 0 ? touch::turned_about(v, rad / angle, angle) : v;
}

}  // namespace

HandBegin begin_of(const DeviceScene& scene) {
  if (scene.begin) return *scene.begin;
  const grid::Lattice& l = scene.contact.volume().voxels;
  const Vec3 middle = l.to_world_mm(Vec3{l.size[0] - 1.0, l.size[1] - 1.0, l.size[2] - 1.0} * 0.5);
  const double reach = norm({l.size[0] * l.spacing_mm.x, l.size[1] * l.spacing_mm.y, l.size[2] * l.spacing_mm.z});
  const contact::Contact c = scene.contact.intersect(middle + Vec3{0, 0, reach}, middle, 0, scene.faces);
  return {c.point_mm + Vec3{0, 0, above_mm}, {0, 0, 1}};
}

RateHand::RateHand(const RateHandParams& params, const DeviceScene& scene)
    : params_(params),
      view_(scene.view),
      hand_({0.2, params.push_stiffness_n_per_mm, spring_damping + own_damping, params.push_most_n}, {}) {
  const HandBegin begin = begin_of(scene);
  goal_mm_ = begin.tip_mm;
  axis_goal_ = axis_ = normalized(begin.axis);
  hand_.put(begin.tip_mm);
}

double RateHand::speed(double push) const {
  if (!(std::abs(push) > params_.push_dead_ratio)) return 0;  // also what is not a number
  const double share = (std::min(1.0, std::abs(push)) - params_.push_dead_ratio) / (1 - params_.push_dead_ratio);
  return std::copysign(share * share, push);
}

bool RateHand::read(double dt_s, DeviceReading& out) {
  pushes_.read(push_);
  if (view_) view_->read(axes_);
  const double span = std::clamp(dt_s, 0.0, 0.1);
  const Vec3 toward = cross(axes_.right, axes_.up);
  const auto in_case = [&](Vec3 v) { return axes_.right * v.x + axes_.up * v.y + toward * v.z; };
  const Vec3 move = in_case(speed(push_.move)) - axis_ * speed(push_.ahead);
  goal_mm_ += move * (params_.push_mm_per_s * span);
  const double most = 1.2 * std::max(hand_.reach_mm(), axes_.min_most_n / params_.push_stiffness_n_per_mm);
  if (const Vec3 behind = goal_mm_ - hand_.position_mm(); norm(behind) > most)
    goal_mm_ = hand_.position_mm() + behind * (most / norm(behind));
  axis_goal_ =
      normalized(turned_by(axis_goal_, in_case(speed(push_.turn)) * (params_.push_deg_per_s * M_PI / 180 * span)));
  hand_.follow(goal_mm_, dt_s, axes_.min_most_n);
  axis_ = turned_towards(axis_, axis_goal_, dt_s);
  out = {};
  out.tip_mm = hand_.position_mm();
  out.axis = axis_;
  out.buttons = push_.buttons;
  return !lost_.load(std::memory_order_relaxed) && is_finite(out.tip_mm);
}

}  // namespace trephine::device
