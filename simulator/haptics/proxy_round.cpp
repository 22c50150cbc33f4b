// SPDX-License-Identifier: GPL-3.0-or-later
// The proxy of a round tool: the middle lines of its parts are held off surfaces by their radii. Planes hold back the
// centre, which is the foremost end of the first middle line. A wall that holds back another place of a line holds the
// centre back as a plane that is moved by the way from that place to the centre.
#include <algorithm>
#include <cmath>

#include "haptics/proxy.h"

namespace trephine::haptics {
namespace {

constexpr int max_passes = 8, max_steps = 256;
constexpr int max_turn_steps = 16, give_passes = 4;
constexpr double turn_step_ratio = 0.25;  // of the smallest radius or voxel side: how far a turn's step moves the tail
constexpr double max_looks = 4000;        // places that are tried in a frame, on the way out of bone

std::uint64_t bit(int shape) { return shape != 0 ? std::uint64_t{1} << shape : 0; }

}  // namespace

// Whether the next frames go on with what is left to do in this one; never while the tool is drawn out.
bool Proxy::round_is_busy(double share) const { return !draws_out() && round_->busy(share); }

// Whether the tool may begin there: it touches nothing, and no middle line lies in a shape that nothing enters.
bool Proxy::round_is_free(Vec3 centre, Vec3 axis) {
  const double step = std::max(0.5, round_->smallest_radius_mm());
  const int places = int(std::ceil(round_->length_mm() / step));
  for (int n = 0; n <= places; ++n) {
    const int shape = contact_.shape_at(centre + axis * std::min(n * step, round_->length_mm()));
    if (shape != 0 && feels_[std::size_t(shape)].front.touchable &&
        !(feels_[std::size_t(shape)].front.pop_through_n > 0))
      return false;
  }
  return !round_->deepest(centre, axis, contact_.shape_at(centre), closed_faces()).hit;
}

void Proxy::begin_round(const HapticInput& in) {
  const Vec3 centre = in.tip_mm + in.axis * round_->centre_mm();
  open_ = {0, 0};
  round_->begin_frame();
  Vec3 at = centre;
  begun_ = round_is_free(at, in.axis);
  // A few places are tried in each frame, each time a little further away.
  const int looks = std::clamp(int(max_looks / (1 + round_->length_mm() / round_->smallest_radius_mm())), 2, 40);
  for (int n = 0; !begun_ && !way_out_.exhausted() && n < looks; ++n) {
    const Vec3 way = way_out_.next_mm(in.axis);
    at = centre + way;
    begun_ = way != Vec3{} && round_is_free(at, in.axis);
  }
  if (!begun_) {
    at = centre;
    begun_ = way_out_.exhausted();
  }
  centre_mm_ = at;
  state_.axis = in.axis;
  state_.inside = contact_.shape_at(at);
  state_.proxy_mm = moved_from_mm_ = at - in.axis * round_->centre_mm();
}

// Moves the centre straight towards the goal, to the first place where the tool touches.
RoundBody::Touch Proxy::move_round(Vec3 goal) {
  const Vec3 begin = centre_mm_, way = goal - begin;
  const double length = norm(way), step = 0.5 * std::min(round_->smallest_radius_mm(), contact_.smallest_side_mm());
  const int steps = std::clamp(int(std::ceil(length / step)), 1, max_steps);
  const double share = std::min(1.0, max_steps * step / std::max(length, 1e-12));
  for (int n = 1; n <= steps; ++n) {
    if (n > 1 && round_is_busy(1)) return {};
    const Vec3 next = begin + way * (share * n / steps);
    const contact::Contact through = contact_.cross(centre_mm_, next, state_.inside, closed_faces());
    if (through.hit) return {};  // its centre never passes a surface
    const RoundBody::Touch touch = round_->deepest(next, state_.axis, through.into, closed_faces());
    if (touch.hit) {
      RoundBody::Touch close = close_to(next, touch);
      if (!draws_out()) round_->set_on_edge(close, state_.axis);
      return close;
    }
    centre_mm_ = next;
    state_.inside = through.into;
  }
  return {};
}

// Moves the centre on to just before the place where the tool touches, which lies within the step to `next`.
RoundBody::Touch Proxy::close_to(Vec3 next, RoundBody::Touch touch) {
  constexpr int halvings = 3;
  Vec3 beyond = next;
  for (int n = 0; n < halvings; ++n) {
    const Vec3 middle = (centre_mm_ + beyond) * 0.5;
    const RoundBody::Touch there = round_->deepest(middle, state_.axis, state_.inside, closed_faces());
    if (there.hit) {
      beyond = middle;
      touch = there;
      continue;
    }
    const contact::Contact through = contact_.cross(centre_mm_, middle, state_.inside, closed_faces());
    if (through.hit || through.into != state_.inside) return touch;
    centre_mm_ = middle;
  }
  return touch;
}

// Turns the tool about its tip towards the axis, in steps so small that no place of it can pass a wall. Where it would
// touch, it moves away from the wall, if that helps; else it keeps its axis for this frame.
void Proxy::turn_round(Vec3 axis) {
  const double reach = round_->length_mm() + round_->centre_mm();
  const double step = turn_step_ratio * std::min(round_->smallest_radius_mm(), contact_.smallest_side_mm());
  for (int n = 0; n < max_turn_steps && !(state_.axis == axis); ++n) {
    if (round_is_busy(0.5)) return;
    const bool last = norm(axis - state_.axis) <= step / reach;
    const Vec3 next = last ? axis : turned(frame_along(state_.axis), axis, step / reach).column[2];
    const Vec3 begin = centre_mm_ + (next - state_.axis) * round_->centre_mm();
    Vec3 to = begin;
    RoundBody::Touch touch = round_->deepest(to, next, state_.inside, closed_faces());
    for (int pass = 0; pass < give_passes && touch.hit; ++pass) {
      to += touch.contact.normal * (touch.depth_mm + margin_mm_);
      if (norm(to - begin) > 2 * step) break;
      touch = round_->deepest(to, next, state_.inside, closed_faces());
    }
    if (touch.hit) return;
    const contact::Contact through = contact_.cross(centre_mm_, to, state_.inside, closed_faces());
    if (through.hit) return;
    centre_mm_ = to;
    state_.axis = next;
    state_.inside = through.into;
  }
}

void Proxy::follow_round(const HapticInput& in) {
  round_->begin_frame();
  const std::uint64_t open = open_.front | open_.back;
  if (open != 0 && !(bit(state_.inside) & open) && !round_->reaches(centre_mm_, state_.axis, open)) open_ = {0, 0};
  if (round_->is_ball())
    state_.axis = in.axis;
  else
    turn_round(in.axis);
  const Vec3 device = in.tip_mm + state_.axis * round_->centre_mm();
  surfaces_.clear();
  Vec3 goal = device;
  for (int pass = 0; pass < max_passes && !(pass > 1 && round_is_busy(1)); ++pass) {
    const RoundBody::Touch touch = move_round(goal);
    if (!touch.hit || !meet_round(touch, device, goal)) break;
  }
  if (!round_->is_ball()) {
    if (draws_out()) slide_out_round(device);
    note_drawn(in.tip_mm + state_.axis * round_->centre_mm() - centre_mm_);
  }
  if (surfaces_.count() == 0) friction_.rest();
}

// Where two shapes are touched at once, as the floor of a hole that is thin in places and what lies behind it, both are
// felt, by how deep the tool is in either. The one that was named before stays named as long as it has two fifths.
HeldSurface Proxy::held_of(const RoundBody::Touch& touch) const {
  HeldSurface is = held(touch.contact);
  if (!touch.beside.hit || !(touch.beside_share > 0)) return is;
  const HeldSurface other = held(touch.beside);
  const auto mixed = [&](double cases::CaseFace::*value) {
    is.feel.*value += (other.feel.*value - is.feel.*value) * touch.beside_share;
  };
  mixed(&cases::CaseFace::stiffness_n_per_mm);
  mixed(&cases::CaseFace::damping_n_s_per_mm);
  mixed(&cases::CaseFace::static_friction_ratio);
  mixed(&cases::CaseFace::dynamic_friction_ratio);
  is.grain = is.grain.mixed(other.grain, touch.beside_share);
  if (other.shape == state_.touched && touch.beside_share > 0.4) {
    is.shape = other.shape;
    is.face = other.face;
  }
  return is;
}

// As meet(), for a round tool.
bool Proxy::meet_round(const RoundBody::Touch& touch, Vec3 device, Vec3& goal) {
  const contact::Contact& c = touch.contact;
  const bool alone = round_->is_ball();
  contact::Plane plane{c.point_mm + c.normal * (touch.radius_mm + margin_mm_) - state_.axis * touch.along_mm, c.normal};
  const int at = surfaces_.place_of(c.normal);
  if (at == HeldSurfaces::max_count) return false;
  // Where two places of a rod touch one surface, the plane of the one that reaches further counts.
  if (at < surfaces_.count() && !alone && dot(plane.normal, surfaces_.plane(at).point_mm - plane.point_mm) > 0)
    plane.point_mm = surfaces_.plane(at).point_mm;
  HeldSurface surface = held_of(touch);
  surface.arm_mm = state_.axis * (round_->centre_mm() + touch.pressed_mm) - c.normal * touch.radius_mm;
  surfaces_.set(at, plane, surface);
  if (!surfaces_.solve(device)) return false;
  const cases::CaseFace& feel = surface.feel;
  if (feel.pop_through_n > 0 && feel.stiffness_n_per_mm * surfaces_.pressure_mm(at) > feel.pop_through_n) {
    // Both faces open, because halfway through, the tool lies on both sides of the surface. A shape that nothing enters
    // stays closed, even where the soft tissue that was popped through lies against it.
    for (const int shape : {c.into, c.from}) {
      const ShapeFeel& own = feels_[std::size_t(shape)];
      if (!(own.front.pop_through_n > 0 || own.back.pop_through_n > 0)) continue;
      open_.front |= bit(shape);
      open_.back |= bit(shape);
    }
    state_.events |= haptic_event::popped;
    surfaces_.clear();
    goal = device;
    return true;
  }
  // The tool may stand up to a step away from the plane: it moves up to the plane first.
  const double off = dot(plane.normal, centre_mm_ - plane.point_mm);
  if (off < 0 || off > 2 * margin_mm_) {
    const Vec3 to = centre_mm_ - plane.normal * off;
    const contact::Contact through = contact_.cross(centre_mm_, to, state_.inside, closed_faces());
    const RoundBody::Touch there = through.hit || (alone && off < 0)
                                       ? RoundBody::Touch{}
                                       : round_->deepest(to, state_.axis, through.into, closed_faces());
    if (!through.hit && (!there.hit || (off < 0 && there.depth_mm < touch.depth_mm))) {
      centre_mm_ = to;
      state_.inside = through.into;
    }
  }
  return friction_.slide(surfaces_, at, centre_mm_, device, goal);
}

}  // namespace trephine::haptics
