// SPDX-License-Identifier: GPL-3.0-or-later
// The proxy of a ball: its centre is held off surfaces by the radius. Planes are for the centre.
#include <algorithm>
#include <cmath>

#include "haptics/proxy.h"

namespace trephine {
namespace {

constexpr int most_passes = 8, most_steps = 256;

std::uint64_t bit(int shape) { return shape != 0 ? std::uint64_t{1} << shape : 0; }

}  // namespace

void Proxy::begin_ball(const HapticInput& in) {
  const Vec3 centre = in.tip_mm + in.axis * ball_->radius_mm();
  open_ = {0, 0};
  const TouchableFaces closed = closed_faces();
  const auto free = [&](Vec3 at) {
    const int shape = contact_.shape_at(at);
    const bool solid = shape != 0 && feels_[std::size_t(shape)].front.touchable &&
                       !(feels_[std::size_t(shape)].front.pop_through_n > 0);
    return !solid && !ball_->deepest(at, shape, closed).hit;
  };
  Vec3 at = centre;
  begun_ = free(at);
  // A few places a frame, each time a little further away.
  for (int looks = 0; !begun_ && exit_mm_ < farthest_exit_mm && looks < 40; ++looks) {
    const Vec3 way = next_exit_ < 0 ? in.axis : exit_way(next_exit_);
    at = centre + way * exit_mm_;
    begun_ = way != Vec3{} && free(at);
    if (++next_exit_ < exit_ways) continue;
    next_exit_ = -1;
    exit_mm_ *= 1.25;
  }
  if (!begun_) {
    at = centre;
    begun_ = !(exit_mm_ < farthest_exit_mm);
  }
  ball_mm_ = at;
  state_.axis = in.axis;
  state_.inside = contact_.shape_at(at);
  state_.proxy_mm = moved_from_mm_ = at - in.axis * ball_->radius_mm();
}

// Moves the centre straight towards the goal, to the first place where the ball touches.
BallBody::Touch Proxy::move_ball(Vec3 goal) {
  const Vec3 begin = ball_mm_, way = goal - begin;
  const double length = norm(way), step = 0.5 * std::min(ball_->radius_mm(), contact_.smallest_side_mm());
  const int steps = std::clamp(int(std::ceil(length / step)), 1, most_steps);
  const double share = std::min(1.0, most_steps * step / std::max(length, 1e-12));
  for (int n = 1; n <= steps; ++n) {
    const Vec3 next = begin + way * (share * n / steps);
    const Contact through = contact_.cross(ball_mm_, next, state_.inside, closed_faces());
    if (through.hit) return {};  // its centre never passes a surface
    const BallBody::Touch touch = ball_->deepest(next, through.into, closed_faces());
    if (touch.hit) return touch;
    ball_mm_ = next;
    state_.inside = through.into;
  }
  return {};
}

void Proxy::follow_ball(const HapticInput& in) {
  const Vec3 device = in.tip_mm + in.axis * ball_->radius_mm();
  ball_->forget();
  if ((open_.front | open_.back) != 0 && !(bit(state_.inside) & (open_.front | open_.back)) &&
      !ball_->reaches(ball_mm_, open_.front | open_.back))
    open_ = {0, 0};
  count_ = 0;
  solved_ = false;
  Vec3 goal = device;
  for (int pass = 0; pass < most_passes; ++pass) {
    const BallBody::Touch touch = move_ball(goal);
    if (!touch.hit || !meet_ball(touch, device, goal)) break;
  }
  if (count_ == 0) sliding_ = false;
  for (int n = 0; n < count_; ++n) held_[n].arm_mm = (in.axis - planes_[n].normal) * ball_->radius_mm();
  state_.axis = in.axis;
}

// As meet().
bool Proxy::meet_ball(const BallBody::Touch& touch, Vec3 device, Vec3& goal) {
  const Contact& c = touch.contact;
  const Plane plane{c.point_mm + c.normal * (ball_->radius_mm() + margin_mm_), c.normal};
  int at = count_;
  for (int n = 0; n < count_; ++n)
    if (dot(planes_[n].normal, c.normal) > same_surface) at = n;
  if (at == 3) return false;
  planes_[at] = plane;
  held_[at] = held(c);
  count_ = std::max(count_, at + 1);
  solved_ = nearest_before(planes_, count_, device, nearest_);
  if (!solved_) return false;
  const CaseFace& feel = held_[at].feel;
  if (feel.pop_through_n > 0 && feel.stiffness_n_per_mm * nearest_.pressure_mm[at] > feel.pop_through_n) {
    open_.front |= bit(c.into);
    open_.back |= bit(c.from);
    state_.events |= haptic_event::popped;
    count_ = 0;
    solved_ = false;
    goal = device;
    return true;
  }
  // Where it stands the ball is up to a step away from the plane: it comes up to it first.
  const double off = dot(planes_[at].normal, ball_mm_ - planes_[at].point_mm);
  if (off < 0 || off > 2 * margin_mm_) {
    const Vec3 to = ball_mm_ - planes_[at].normal * off;
    const Contact through = contact_.cross(ball_mm_, to, state_.inside, closed_faces());
    if (!through.hit && (off < 0 || !ball_->deepest(to, through.into, closed_faces()).hit)) {
      ball_mm_ = to;
      state_.inside = through.into;
    }
  }
  const Vec3 way = nearest_.point_mm - ball_mm_;
  const double length = norm(way), depth = norm(nearest_.point_mm - device);
  if (!slides(feel, length, depth)) return false;
  goal = ball_mm_ + way * (1 - feel.dynamic_friction_ratio * depth / length);
  return true;
}

}  // namespace trephine
