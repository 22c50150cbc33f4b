// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/proxy.h"

#include <algorithm>
#include <cmath>

namespace trephine::haptics {
namespace {

constexpr int max_passes = 6;
constexpr double motion_mm = 0.1;  // how far the proxy moves for an event

bool usable(Vec3 p) { return std::abs(p.x) <= 1e6 && std::abs(p.y) <= 1e6 && std::abs(p.z) <= 1e6; }  // not for NaN

}  // namespace

std::string fault_names(std::uint32_t faults) {
  std::string out;
  for (int n = 0; n < haptic_fault::count; ++n)
    if (faults >> n & 1) out += (out.empty() ? "" : ", ") + std::string(haptic_fault::names[n]);
  return out;
}

Proxy::Proxy(const contact::ContactVolume& contact, const Feels& feels, const ForceParams& force,
             const ShaftParams& shaft, const Tool& tool)
    : contact_(contact),
      feels_(feels),
      force_(force),
      faces_(touchable_of(feels)),
      slew_(force),
      shaft_(shaft.shaft_length_mm > 0 ? shaft.shaft_length_mm : tool.length_mm),
      tool_(tool) {
  if (!tool.points_mm.empty()) body_.emplace(contact, tool.points_mm);
  if (!tool.round.empty()) round_.emplace(contact, tool.round);
  const Vec3 s = contact.volume().voxels.spacing_mm;
  margin_mm_ = 1e-3 * contact.smallest_side_mm();
  const bool boxes = contact.params().surface == contact::ContactParams::Surface::nearest;
  stepped_ = contact.params().walk == contact::ContactParams::Walk::stepped;
  for (const ShapeFeel& f : feels_)
    stiffest_n_per_mm_ = std::max({stiffest_n_per_mm_, f.front.stiffness_n_per_mm, f.back.stiffness_n_per_mm});
  step_mm_ = boxes ? 1.05 * std::max({s.x, s.y, s.z}) : 0.1 * contact.smallest_side_mm();
}

void Proxy::latch(std::uint32_t fault) {
  state_.faults |= fault;
  state_.force_n = state_.torque_n_mm = {};
}

void Proxy::reset() {
  state_ = {};
  begun_ = false;
  friction_.rest();
  surfaces_.clear();
  ease_.reset();
  slew_.reset();
  way_out_ = {};
}

const HapticState& Proxy::update(const HapticInput& given) {
  HapticInput in = given;
  state_.events = 0;
  if (!usable(in.tip_mm) || !usable(in.axis) || !usable(in.extra_n)) latch(haptic_fault::pose);
  if (!(in.dt_s > 0 && in.dt_s <= force_.max_step_s)) latch(haptic_fault::time_step);
  if (state_.faults != 0) {
    state_.force_n = state_.torque_n_mm = {};
    return state_;
  }
  in.across = usable_across(in.across, in.axis);
  if (in.buttons & haptic_button::lifted) {
    reset();
    state_.proxy_mm = in.tip_mm;
    if (in.axis != Vec3{}) state_.axis = normalized(in.axis);
    return state_;
  }
  const Vec3 sent = state_.force_n;  // of a tool that was away
  if (in.away) {
    reset();
    state_.proxy_mm = in.tip_mm;
    if (in.axis != Vec3{}) state_.axis = normalized(in.axis);
    state_.force_n = limited({}, sent, in);
    return state_;
  }
  if (round_) in.axis = in.axis == Vec3{} ? state_.axis : normalized(in.axis);
  if (!begun_) {
    begin(in);
    state_.force_n = begun_ ? sent : limited({}, sent, in);
  }
  if (!begun_) return state_;  // a tool that is still looking for its way out
  const HapticState before = state_;

  const double slowness = force_.velocity_cutoff_hz > 0 ? 1 / (2 * M_PI * force_.velocity_cutoff_hz) : 0;
  const double moved_mm = norm(in.tip_mm - device_mm_);
  velocity_ += ((in.tip_mm - device_mm_) / in.dt_s - velocity_) * (in.dt_s / (in.dt_s + slowness));
  device_mm_ = in.tip_mm;
  since_s_ += in.dt_s;
  friction_.pass(in.dt_s);
  Vec3 pressed_mm = in.tip_mm;  // the point that the planes hold back
  if (body_) {
    follow_tool(in);
  } else if (round_) {
    follow_round(in);
    pressed_mm += state_.axis * round_->centre_mm();
    state_.proxy_mm = centre_mm_;
  } else {
    state_.axis = in.axis;
    follow(in.tip_mm);
    // A stepped walk may end in a corner of bone between two samples, and a proxy that stopped there would be caught.
    if (stepped_ && contact_.shape_at(state_.proxy_mm) != state_.inside) {
      state_.proxy_mm = before.proxy_mm;
      state_.inside = before.inside;
    }
  }

  hold_corner(pressed_mm);
  Vec3 force = surface_force(pressed_mm);
  if (round_) state_.proxy_mm = centre_mm_ - state_.axis * round_->centre_mm();
  const double explained_n = 2 * stiffest_n_per_mm_ * moved_mm;
  force = ease_.ease(force + inside_force(in), explained_n, in.dt_s, force_.release_s) + in.extra_n;
  if (since_s_ < force_.ramp_s) force = force * (since_s_ / force_.ramp_s);
  if (in.breached) state_.events |= haptic_event::breach;
  const bool event = state_.events & (haptic_event::breach | haptic_event::popped);
  force = slew_.follow(force, in.drilling, event, explained_n, in.dt_s);
  const double size = norm(force);
  if (!(size <= force_.max_force_n)) {
    if (!std::isfinite(size)) {
      latch(haptic_fault::force);
      return state_;
    }
    force = force * (force_.max_force_n / size);
  }
  state_.force_n = limited(force, before.force_n, in);
  set_torque(in, before.torque_n_mm);
  note_events(before);
  return state_;
}

// Places the proxy where the device is; or, where that is in a shape that nothing enters, on the nearest surface.
void Proxy::begin(const HapticInput& in) {
  begun_ = true;
  state_ = {};
  state_.proxy_mm = device_mm_ = moved_from_mm_ = in.tip_mm;
  state_.inside = contact_.shape_at(in.tip_mm);
  velocity_ = {};
  since_s_ = 0;
  shaft_.begin();
  if (body_) return begin_tool(in);
  if (round_) return begin_round(in);
  const cases::CaseFace& front = feels_[std::size_t(state_.inside)].front;
  if (state_.inside == 0 || !front.touchable || front.pop_through_n > 0) return;
  double nearest = WayOut::farthest_mm;
  const contact::TouchableFaces ways_out{0, std::uint64_t{1} << state_.inside};
  const int inside = state_.inside;
  for (int n = 0; n < WayOut::ways; ++n) {
    const Vec3 way = WayOut::way(n);
    const contact::Contact c = contact_.cross(in.tip_mm, in.tip_mm + way * nearest, inside, ways_out);
    if (!c.hit) continue;
    const Vec3 outside = c.point_mm + way * margin_mm_;
    if (contact_.shape_at(outside) == inside) continue;
    nearest *= c.along;
    state_.proxy_mm = outside;
    state_.inside = contact_.shape_at(outside);
  }
}

HeldSurface Proxy::held(const contact::Contact& c) const {
  const ShapeFeel& shape = feels_[std::size_t(c.shape)];
  const bool front = c.face == contact::ContactFace::front;
  const cases::CaseFace& feel = front ? shape.front : shape.back;
  return {c.shape, front ? 1 : 2, c.into, feel, Grain(shape, feel), {}};
}

// The place straight under `from` that lies as deep as the device.
Vec3 Proxy::straight_under(Vec3 from, Vec3 normal, Vec3 device) {
  return from - normal * std::max(0.0, dot(normal, from - device));
}

// Moves the proxy to just before the contact, a margin off its surface. A proxy that is already there stays, or it
// would creep along although friction holds it.
void Proxy::approach(const contact::Contact& c) {
  const Vec3 way = c.point_mm - state_.proxy_mm;
  const double length = norm(way);
  state_.inside = c.from;
  if (length <= 4 * margin_mm_) return;
  const Vec3 before = state_.proxy_mm + way * (1 - margin_mm_ / length);
  const contact::Contact off = contact_.cross(before, c.point_mm + c.normal * margin_mm_, c.from, faces_);
  state_.proxy_mm = off.hit ? before : off.point_mm;
  if (!off.hit) state_.inside = off.into;
}

void Proxy::follow(Vec3 device) {
  surfaces_.clear();
  Vec3 goal = device;
  for (int pass = 0; pass < max_passes; ++pass) {
    const contact::Contact c = contact_.intersect(state_.proxy_mm, goal, state_.inside, faces_);
    if (!c.hit) {
      state_.proxy_mm = goal;
      state_.inside = c.into;
      break;
    }
    if (!meet(c, device, goal, pass)) break;
  }
  if (surfaces_.count() == 0) friction_.rest();
}

// Takes a contact in: pops through it, or adds its plane and sets the next goal. False where the proxy stays for this
// frame.
bool Proxy::meet(const contact::Contact& c, Vec3 device, Vec3& goal, int pass) {
  const Vec3 before = state_.proxy_mm;
  approach(c);
  const int at = surfaces_.place_of(c.normal);
  if (at == HeldSurfaces::max_count) return false;
  const bool known = at < surfaces_.count();
  // A surface is rougher than its smooth normal says, and may bar the way along its own tangent plane. The proxy then
  // climbs over the roughness; where it cannot, it takes the exact normal.
  const bool barred = known && pass > 0;
  if (barred && step_over(c, device, goal)) return false;
  Vec3 normal = c.normal;
  if (barred) {
    const Vec3 exact = contact_.exact_normal(c, goal - before);
    if (exact == Vec3{}) return false;
    if (dot(exact, goal - before) < 0) normal = exact;
  }
  surfaces_.set(at, {c.point_mm + normal * margin_mm_, normal}, held(c));
  if (!surfaces_.solve(device)) return false;

  const cases::CaseFace& feel = surfaces_.surface(at).feel;
  if (feel.pop_through_n > 0 && feel.stiffness_n_per_mm * surfaces_.pressure_mm(at) > feel.pop_through_n) {
    const Vec3 in = c.point_mm - c.normal * margin_mm_;
    const int inside = contact_.shape_at(in);
    if (inside != c.from) {
      state_.proxy_mm = in;
      state_.inside = inside;
      state_.events |= haptic_event::popped;
      surfaces_.clear();
      goal = device;
      return true;
    }
  }
  return friction_.slide(surfaces_, at, state_.proxy_mm, device, goal);
}

// Goes up by a step, along, and down towards the device; false where that is barred as well.
bool Proxy::step_over(const contact::Contact& c, Vec3 device, Vec3 goal) {
  const Vec3 up = c.normal * step_mm_;
  const Vec3 top = state_.proxy_mm + up;
  const contact::Contact rise = contact_.cross(state_.proxy_mm, top, state_.inside, faces_);
  if (rise.hit) return false;
  const contact::Contact across = contact_.cross(top, goal + up, rise.into, faces_);
  if (across.hit && across.along < 0.5) return false;
  const double share = across.hit ? std::max(0.0, across.along - 0.01) : 1;
  state_.proxy_mm = top + (goal + up - top) * share;
  state_.inside = across.hit ? across.from : across.into;
  // Friction that turns a tool aside is not to be lost on the way down: there the tool goes straight down first.
  const bool straight = held(c).grain.any();
  const Vec3 below = straight ? straight_under(state_.proxy_mm, c.normal, device) : device;
  contact::Contact down = contact_.intersect(state_.proxy_mm, below, state_.inside, faces_);
  if (straight && !down.hit) {
    state_.proxy_mm = below;
    state_.inside = down.into;
    down = contact_.intersect(below, device, state_.inside, faces_);
  }
  if (down.hit) {
    approach(down);
  } else {
    state_.proxy_mm = device;
    state_.inside = down.into;
    surfaces_.clear();
  }
  return true;
}

// Surfaces beside the tool may bar its way although none of their planes holds the device back, as in a narrow hole.
// Then the spring from the proxy to the device is felt, and not for a tick nothing.
void Proxy::hold_corner(Vec3 device) {
  if (surfaces_.count() == 0 || !surfaces_.solved() || !(norm(state_.proxy_mm - device) > 4 * margin_mm_)) return;
  if (!surfaces_.any_presses()) surfaces_.leave_unsolved();
}

Vec3 Proxy::surface_force(Vec3 device) {
  const HeldSurfaces::Felt felt = surfaces_.felt(state_.proxy_mm, device, velocity_, state_.touched);
  state_.touched = felt.shape;
  state_.face = felt.face;
  state_.held_by = felt.count;
  state_.normal = felt.normal;
  pressed_n_mm_ = felt.torque_n_mm;
  return felt.force_n;
}

// Drag on the tip, and what the tissue holds of the shaft.
Vec3 Proxy::inside_force(const HapticInput& in) {
  const Vec3 drag = velocity_ * -feels_[std::size_t(state_.inside)].drag_n_s_per_mm;
  return drag - shaft_.force_n(contact_, feels_, state_.proxy_mm, state_.axis, velocity_, in.dt_s);
}

void Proxy::note_events(const HapticState& before) {
  if (before.touched != 0 && before.touched != state_.touched) state_.events |= haptic_event::untouch;
  if (state_.touched != 0 && before.touched != state_.touched) {
    state_.events |= haptic_event::touch;
    moved_from_mm_ = state_.proxy_mm;
  }
  if (state_.touched != 0 && norm(state_.proxy_mm - moved_from_mm_) > motion_mm) {
    state_.events |= haptic_event::motion;
    moved_from_mm_ = state_.proxy_mm;
  }
  if (before.inside != 0 && before.inside != state_.inside) state_.events |= haptic_event::left;
}

}  // namespace trephine::haptics
