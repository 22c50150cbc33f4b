// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/proxy_round.h"

#include <algorithm>
#include <cmath>

namespace trephine::haptics {
namespace {

constexpr int max_passes = 8, max_steps = 256;
constexpr int max_turn_steps = 16, give_passes = 4;
constexpr double turn_step_ratio = 0.25;  // of the smallest radius or voxel side: how far a turn's step moves the tail
constexpr double max_looks = 4000;        // places that are tried in a frame, on the way out of bone
constexpr double touching_ratio = 0.02;   // of a voxel's side: as deep as discs let a round tool be
constexpr int out_tries = 4;
constexpr double drawn_share = 1.5;  // of a frame's work, after which the next frames go on to try places

}  // namespace

// Whether the next frames go on with what is left to do in this one; never while the tool is drawn out.
bool ProxyRound::is_busy(double share) const { return !drawn_.draws_out() && body_.busy(share); }

// Whether the tool may begin there: it touches nothing, and no middle line lies in a shape that nothing enters.
bool ProxyRound::is_free(Vec3 centre, Vec3 axis) {
  const double step = std::max(0.5, body_.smallest_radius_mm());
  const int places = int(std::ceil(body_.length_mm() / step));
  for (int n = 0; n <= places; ++n) {
    if (ground_.is_solid(contact_.shape_at(centre + axis * std::min(n * step, body_.length_mm())))) return false;
  }
  if (contact_.inside_mesh(centre, closed_faces())) return false;
  return !deepest(centre, axis, contact_.shape_at(centre), closed_faces()).hit;
}

// Of the volume and of the surfaces beside it the touch that is deepest. No middle line ever passes a surface: a step
// is shorter than a radius.
RoundBody::Touch ProxyRound::deepest(Vec3 centre, Vec3 axis, int inside, const contact::TouchableFaces& faces) {
  RoundBody::Touch t = body_.deepest(centre, axis, inside, faces);
  if (!contact_.meshes()) return t;
  for (std::size_t n = 0; n < body_.parts().size(); ++n) {
    const RoundPart& part = body_.parts()[n];
    const double reach = part.radius_mm - t.depth_mm;
    const touch::MeshSurfaces::Meeting m = contact_.meshes()->nearest(
        centre + axis * part.from_mm, centre + axis * part.to_mm, reach, part.radius_mm, faces.front, near_[n]);
    body_.spend(near_[n].looked_at);
    near_[n].looked_at = 0;
    if (m.shape == 0) continue;
    t = {};
    t.hit = t.contact.hit = true;
    t.depth_mm = part.radius_mm - m.distance_mm;
    t.radius_mm = part.radius_mm;
    t.along_mm = t.pressed_mm = part.from_mm + m.along * (part.to_mm - part.from_mm);
    t.contact.point_mm = m.point_mm;
    t.contact.normal = m.normal;
    t.contact.face = m.front ? contact::ContactFace::front : contact::ContactFace::back;
    t.contact.shape = m.shape;
    t.contact.from = t.contact.into = inside;
  }
  return t;
}

// A rod that lies on a surface presses in the middle of all places that are as near to it.
void ProxyRound::press_along(RoundBody::Touch& t) {
  constexpr int places = 8;
  if (!touch::is_mesh(t.contact.shape) || body_.is_ball()) return;
  const double reach = t.radius_mm - t.depth_mm + ground_.step_mm;
  double first = t.along_mm, last = t.along_mm;
  for (const RoundPart& part : body_.parts()) {
    if (part.radius_mm != t.radius_mm || !(part.to_mm > part.from_mm)) continue;
    for (int n = 0; n <= places; ++n) {
      const double at = part.from_mm + (part.to_mm - part.from_mm) * n / places;
      const Vec3 place = centre_mm_ + state_.axis * at;
      const auto m = contact_.meshes()->nearest(place, place, reach, shape_bit(t.contact.shape));
      if (m.shape == 0 || dot(m.normal, t.contact.normal) < HeldSurfaces::same_facet) continue;
      first = std::min(first, at);
      last = std::max(last, at);
    }
  }
  t.pressed_mm = 0.5 * (first + last);
}

// A few places are tried in each frame, each time a little further away.
bool ProxyRound::begin(const HapticInput& in) {
  const Vec3 centre = in.tip_mm + in.axis * body_.centre_mm();
  open_ = {};
  body_.begin_frame();
  for (touch::NearFacets& near : near_) near.forget();
  Vec3 at = centre;
  bool begun = is_free(at, in.axis);
  const int looks = std::clamp(int(max_looks / (1 + body_.length_mm() / body_.smallest_radius_mm())), 2, 40);
  for (int n = 0; !begun && !ground_.way_out.exhausted() && n < looks; ++n) {
    const Vec3 way = ground_.way_out.next_mm(in.axis);
    at = centre + way;
    begun = way != Vec3{} && is_free(at, in.axis);
  }
  if (!begun) {
    at = centre;
    begun = ground_.way_out.exhausted();
  }
  centre_mm_ = at;
  state_.axis = in.axis;
  state_.inside = contact_.shape_at(at);
  state_.proxy_mm = at - in.axis * body_.centre_mm();
  return begun;
}

std::optional<Vec3> ProxyRound::kept_from_turning(const HapticInput& in) const {
  if (state_.axis == in.axis) return {};
  const Mat3 aim = frame_along(in.axis);
  return rotation_between(aim, turned(aim, state_.axis));
}

void ProxyRound::follow(const HapticInput& in) {
  body_.begin_frame();
  const std::uint64_t open = open_.shapes();
  if (open != 0 && !(shape_bit(state_.inside) & open) && !body_.reaches(centre_mm_, state_.axis, open)) open_ = {};
  if (body_.is_ball())
    state_.axis = in.axis;
  else
    turn(in.axis);
  const Vec3 device = wanted_mm(in);
  surfaces_.clear();
  Vec3 goal = device;
  for (int pass = 0; pass < max_passes && !(pass > 1 && is_busy(1)); ++pass) {
    const RoundBody::Touch touch = move(goal);
    if (!touch.hit || !meet(touch, device, goal)) break;
  }
  if (!body_.is_ball()) {
    if (drawn_.draws_out()) slide_out(device);
    drawn_.note(wanted_mm(in) - centre_mm_, state_.axis);
  }
  if (surfaces_.count() == 0) ground_.friction.rest();
  state_.proxy_mm = centre_mm_ - state_.axis * body_.centre_mm();
}

// Moves the centre straight towards the goal, to the first place where the tool touches.
RoundBody::Touch ProxyRound::move(Vec3 goal) {
  const Vec3 begin = centre_mm_, way = goal - begin;
  const double length = norm(way), step = 0.5 * std::min(body_.smallest_radius_mm(), contact_.smallest_side_mm());
  const int steps = std::clamp(int(std::ceil(length / step)), 1, max_steps);
  const double share = std::min(1.0, max_steps * step / std::max(length, 1e-12));
  for (int n = 1; n <= steps; ++n) {
    if (n > 1 && is_busy(1)) return {};
    const Vec3 next = begin + way * (share * n / steps);
    const contact::Contact through = contact_.cross(centre_mm_, next, state_.inside, closed_faces());
    if (through.hit) return {};  // its centre never passes a surface
    const RoundBody::Touch touch = deepest(next, state_.axis, through.into, closed_faces());
    if (touch.hit) {
      RoundBody::Touch close = close_to(next, touch);
      if (!drawn_.draws_out() && !touch::is_mesh(close.contact.shape)) body_.set_on_edge(close, state_.axis);
      press_along(close);
      return close;
    }
    centre_mm_ = next;
    state_.inside = through.into;
  }
  return {};
}

// Moves the centre on to just before the place where the tool touches, which lies within the step to `next`.
RoundBody::Touch ProxyRound::close_to(Vec3 next, RoundBody::Touch touch) {
  constexpr int halvings = 3;
  Vec3 beyond = next;
  for (int n = 0; n < halvings; ++n) {
    const Vec3 middle = (centre_mm_ + beyond) * 0.5;
    const RoundBody::Touch there = deepest(middle, state_.axis, state_.inside, closed_faces());
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
void ProxyRound::turn(Vec3 axis) {
  const double reach = body_.length_mm() + body_.centre_mm();
  const double step = turn_step_ratio * std::min(body_.smallest_radius_mm(), contact_.smallest_side_mm());
  for (int n = 0; n < max_turn_steps && !(state_.axis == axis); ++n) {
    if (is_busy(0.5)) return;
    const bool last = norm(axis - state_.axis) <= step / reach;
    const Vec3 next = last ? axis : turned(frame_along(state_.axis), axis, step / reach).column[2];
    const Vec3 begin = centre_mm_ + (next - state_.axis) * body_.centre_mm();
    Vec3 to = begin;
    RoundBody::Touch touch = deepest(to, next, state_.inside, closed_faces());
    for (int pass = 0; pass < give_passes && touch.hit; ++pass) {
      to += touch.contact.normal * (touch.depth_mm + ground_.margin_mm);
      if (norm(to - begin) > 2 * step) break;
      touch = deepest(to, next, state_.inside, closed_faces());
    }
    if (touch.hit) return;
    const contact::Contact through = contact_.cross(centre_mm_, to, state_.inside, closed_faces());
    if (through.hit) return;
    centre_mm_ = to;
    state_.axis = next;
    state_.inside = through.into;
  }
}

// Where two shapes are touched at once, as the floor of a hole that is thin in places and what lies behind it, both are
// felt, by how deep the tool is in either. The one that was named before stays named as long as it has two fifths.
HeldSurface ProxyRound::held_of(const RoundBody::Touch& touch) const {
  HeldSurface is = ground_.held(touch.contact);
  if (!touch.beside.hit || !(touch.beside_share > 0)) return is;
  const HeldSurface other = ground_.held(touch.beside);
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

// Takes a touch in: pops through it, or adds its plane and sets the next goal. False where the tool stays for this
// frame.
bool ProxyRound::meet(const RoundBody::Touch& touch, Vec3 device, Vec3& goal) {
  const contact::Contact& c = touch.contact;
  const bool alone = body_.is_ball();
  contact::Plane plane{c.point_mm + c.normal * (touch.radius_mm + ground_.margin_mm) - state_.axis * touch.along_mm,
                       c.normal};
  const int at = surfaces_.place_of(c.normal, c.shape);
  if (at == HeldSurfaces::max_count) return false;
  // Where two places of a rod touch one surface, the plane of the one that reaches further counts.
  if (at < surfaces_.count() && !alone && dot(plane.normal, surfaces_.plane(at).point_mm - plane.point_mm) > 0)
    plane.point_mm = surfaces_.plane(at).point_mm;
  HeldSurface surface = held_of(touch);
  surface.arm_mm = state_.axis * (body_.centre_mm() + touch.pressed_mm) - c.normal * touch.radius_mm;
  surfaces_.set(at, plane, surface);
  if (!surfaces_.solve(device)) return false;
  if (ground_.pops(at)) {
    // Both faces open, because halfway through, the tool lies on both sides of the surface. A shape that nothing enters
    // stays closed, even where the soft tissue that was popped through lies against it.
    for (const int shape : {c.into, c.from}) {
      const ShapeFeel& own = ground_.feels[std::size_t(shape)];
      if (!(own.front.pop_through_n > 0 || own.back.pop_through_n > 0)) continue;
      open_.open.front |= shape_bit(shape);
      open_.open.back |= shape_bit(shape);
    }
    state_.events |= haptic_event::popped;
    surfaces_.clear();
    goal = device;
    return true;
  }
  // The tool may stand up to a step away from the plane: it moves up to the plane first.
  const double off = dot(plane.normal, centre_mm_ - plane.point_mm);
  if (off < 0 || off > 2 * ground_.margin_mm) {
    const Vec3 to = centre_mm_ - plane.normal * off;
    const contact::Contact through = contact_.cross(centre_mm_, to, state_.inside, closed_faces());
    const RoundBody::Touch there =
        through.hit || (alone && off < 0) ? RoundBody::Touch{} : deepest(to, state_.axis, through.into, closed_faces());
    if (!through.hit && (!there.hit || (off < 0 && there.depth_mm < touch.depth_mm))) {
      centre_mm_ = to;
      state_.inside = through.into;
    }
  }
  return ground_.friction.slide(surfaces_, at, centre_mm_, device, goal);
}

// As ProxyShell::slide_out() and work_loose(). Its steps are shorter than its radius. Where it is a little in a
// wall already, it takes of the places that were tried the one where it is the least deep.
void ProxyRound::slide_out(Vec3 device) {
  struct Place {
    Vec3 centre, axis;
    int inside;
    double depth_mm;
  };
  const auto deep = [](const RoundBody::Touch& t) { return t.hit ? t.depth_mm : 0; };
  const auto look = [&](Vec3 centre, Vec3 axis) {
    const contact::Contact through = contact_.cross(centre_mm_, centre, state_.inside, closed_faces());
    const double depth_mm = through.hit ? HUGE_VAL : deep(deepest(centre, axis, through.into, closed_faces()));
    return Place{centre, axis, through.into, depth_mm};
  };
  const auto go_to = [&](const Place& place) {
    centre_mm_ = place.centre;
    state_.axis = place.axis;
    state_.inside = place.inside;
  };
  for (int n = 0; n < out_tries; ++n) {
    const double left = dot(device - centre_mm_, state_.axis);
    if (!(left > 0)) return;
    const Vec3 begin = centre_mm_;
    const RoundBody::Touch touch = move(begin + state_.axis * left);
    if (!touch.hit && !(centre_mm_ == begin)) return;
    if (!touch.hit) break;
    const Place aside = look(centre_mm_ + touch.contact.normal * ground_.step_mm, state_.axis);
    if (aside.depth_mm > 0) break;
    go_to(aside);
  }
  Place best = look(centre_mm_, state_.axis);
  const double touches_mm = touching_ratio * contact_.smallest_side_mm();  // counts as free
  for (int n = 0; n < drawn_.tries() && !(n > 0 && body_.busy(drawn_share)); ++n) {
    const DrawnOut::Place to = drawn_.next(frame_along(state_.axis), ground_.step_mm);
    const Vec3 axis = to.frame.column[2];
    const Vec3 turned_mm = (axis - state_.axis) * body_.centre_mm();  // of the centre, about the tip
    const Place place = look(centre_mm_ + to.way_mm + turned_mm, axis);
    if (place.depth_mm > std::max(touches_mm, best.depth_mm)) continue;
    best = place;
    if (place.depth_mm <= touches_mm) break;
  }
  go_to(best);
}

}  // namespace trephine::haptics
