// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/proxy.h"

#include <algorithm>
#include <cmath>

#include "haptics/force_limits.h"

namespace trephine::haptics {
namespace {

constexpr double motion_mm = 0.1;  // how far the proxy moves for an event

bool usable(Vec3 p) { return std::abs(p.x) <= 1e6 && std::abs(p.y) <= 1e6 && std::abs(p.z) <= 1e6; }  // not for NaN

// Surfaces beside the tool may bar its way although none of their planes holds the device back, as in a narrow hole.
// Then the spring from the proxy to the device is felt, and not for a tick nothing.
void hold_corner(HeldSurfaces& surfaces, double from_device_mm, double margin_mm) {
  if (surfaces.count() == 0 || !surfaces.solved() || !(from_device_mm > 4 * margin_mm)) return;
  if (!surfaces.any_presses()) surfaces.leave_unsolved();
}

}  // namespace

std::string fault_names(std::uint32_t faults) {
  std::string out;
  for (int n = 0; n < haptic_fault::count; ++n)
    if (faults >> n & 1) out += (out.empty() ? "" : ", ") + std::string(haptic_fault::names[n]);
  return out;
}

Proxy::Proxy(const touch::FeltSpace& space, const Feels& feels, const ForceParams& force, const ShaftParams& shaft,
             const Tool& tool)
    : force_(force),
      ground_(space, feels),
      body_(proxy_body(ground_, tool)),
      line_(space.line_lock()),
      shaft_(shaft.shaft_length_mm > 0 ? shaft.shaft_length_mm : tool.length_mm),
      bent_{shaft.shaft_rigidity_n_mm2, shaft.shaft_length_mm > 0 ? shaft.shaft_length_mm : tool.length_mm},
      slew_(force) {
  for (const ShapeFeel& f : feels)
    stiffest_n_per_mm_ = std::max({stiffest_n_per_mm_, f.front.stiffness_n_per_mm, f.back.stiffness_n_per_mm});
}

void Proxy::latch(std::uint32_t fault) {
  ground_.state.faults |= fault;
  ground_.state.force_n = ground_.state.torque_n_mm = {};
}

void Proxy::reset() {
  ground_.state = {};
  begun_ = false;
  ground_.friction.rest();
  ground_.surfaces.clear();
  ease_.reset();
  slew_.reset();
  line_.reset();
  off_line_mm_ = {};
  ground_.way_out = {};
  ground_.relaxing.reset();
}

// The tool is shown at the device, and feels nothing.
void Proxy::rest_at(const HapticInput& in) {
  reset();
  ground_.state.proxy_mm = in.tip_mm;
  if (in.axis != Vec3{}) ground_.state.axis = normalized(in.axis);
  ground_.state.across = in.across;
}

const HapticState& Proxy::update(const HapticInput& given) {
  HapticInput in = given;
  HapticState& state = ground_.state;
  state.events = 0;
  if (!usable(in.tip_mm) || !usable(in.axis) || !usable(in.extra_n)) latch(haptic_fault::pose);
  if (!(in.dt_s > 0 && in.dt_s <= force_.max_step_s)) latch(haptic_fault::time_step);
  if (state.faults != 0) {
    state.force_n = state.torque_n_mm = {};
    return state;
  }
  in.across = usable_across(in.across, in.axis);
  if (in.buttons & haptic_button::lifted) {
    rest_at(in);
    return state;
  }
  const Vec3 sent = state.force_n;  // of a tool that was away
  if (in.away) {
    rest_at(in);
    state.force_n = limited_force(force_, {}, sent, in);
    return state;
  }
  in.axis = body_->axis_of(in);
  if (!begun_) {
    begin(in);
    state.force_n = begun_ ? sent : limited_force(force_, {}, sent, in);
  }
  if (!begun_) return state;  // a tool that is still looking for its way out
  const HapticState before = state;

  note_motion(in);
  ground_.giving_way = in.giving_way;
  ground_.held_ratio = in.held_ratio;
  HapticInput led = in;  // by the hand, or along the line that holds it
  if (line_.holds()) {
    led.tip_mm = line_.nearest_to(in.tip_mm);
    led.axis = line_.axis();
  }
  off_line_mm_ = led.tip_mm - in.tip_mm;
  body_->follow(led);
  Vec3 force = force_of(led);
  note_line();
  const double size = norm(force);
  if (!(size <= force_.max_force_n)) {
    if (!std::isfinite(size)) {
      latch(haptic_fault::force);
      return state;
    }
    force = force * (force_.max_force_n / size);
  }
  state.force_n = limited_force(force_, force, before.force_n, in);
  set_torque(in, before.torque_n_mm);
  note_events(before);
  return state;
}

void Proxy::begin(const HapticInput& in) {
  HapticState& state = ground_.state;
  state = {};
  state.proxy_mm = device_mm_ = in.tip_mm;
  state.across = in.across;
  state.inside = ground_.contact.shape_at(in.tip_mm);
  velocity_ = {};
  since_s_ = 0;
  shaft_.begin();
  tip_.begin();
  ground_.relaxing.reset();
  begun_ = body_->begin(in);
  moved_from_mm_ = state.proxy_mm;
}

void Proxy::note_motion(const HapticInput& in) {
  const double slowness = force_.velocity_cutoff_hz > 0 ? 1 / (2 * M_PI * force_.velocity_cutoff_hz) : 0;
  moved_mm_ = norm(in.tip_mm - device_mm_);
  velocity_ += ((in.tip_mm - device_mm_) / in.dt_s - velocity_) * (in.dt_s / (in.dt_s + slowness));
  device_mm_ = in.tip_mm;
  since_s_ += in.dt_s;
  ground_.friction.pass(in.dt_s);
  ground_.relaxing.begin_tick(in.dt_s);
}

// Of the surfaces, of what the tool is in, and of what the tool does; it rises from 0 after the start, and does not
// jump where something gives way.
Vec3 Proxy::force_of(const HapticInput& in) {
  HapticState& state = ground_.state;
  const Vec3 held_mm = body_->held_mm(), wanted_mm = body_->wanted_mm(in);
  hold_corner(ground_.surfaces, norm(held_mm - wanted_mm), ground_.margin_mm);
  const double explained_n = 2 * stiffest_n_per_mm_ * moved_mm_;
  Vec3 force = surface_force(held_mm, wanted_mm) + line_force(in.tip_mm);
  force = ease_.ease(force + inside_force(in), explained_n, in.dt_s, force_.release_s) + in.extra_n;
  if (since_s_ < force_.ramp_s) force = force * (since_s_ / force_.ramp_s);
  if (in.breached) state.events |= haptic_event::breach;
  const bool event = state.events & (haptic_event::breach | haptic_event::popped);
  return slew_.follow(force, in.drilling, event, explained_n, in.dt_s);
}

Vec3 Proxy::surface_force(Vec3 held_mm, Vec3 device_mm) {
  HapticState& state = ground_.state;
  const HeldSurfaces::Felt felt = ground_.surfaces.felt(held_mm, device_mm, velocity_, state.touched, ground_.relaxing);
  ground_.relaxing.end_tick();
  state.touched = felt.shape;
  state.face = felt.face;
  state.held_by = felt.count;
  state.held_at = ground_.surfaces.count();
  // Kept as floats: GCC 12 leaves double(float(x)) of two neighbours unrounded at -O3.
  for (int n = 0; n < state.held_at; ++n)
    for (int a = 0; a < 3; ++a) state.held_mm[n][a] = float(ground_.surfaces.surface(n).at_mm[a]);
  state.normal = felt.normal;
  pressed_n_mm_ = felt.torque_n_mm;
  return felt.force_n;
}

// Drag on the tip, what it cuts, and what the tissue holds of the shaft.
Vec3 Proxy::inside_force(const HapticInput& in) {
  const HapticState& state = ground_.state;
  const ShapeFeel& feel = ground_.feels[std::size_t(state.inside)];
  const Vec3 drag = velocity_ * -feel.drag_n_s_per_mm;
  const Vec3 cut = tip_.force_n(feel.tip_force_n, state.axis, velocity_, in.dt_s);
  const auto held = [&](int shape) { return ground_.feels[std::size_t(shape)].shaft_friction_n_per_mm; };
  return drag + cut - shaft_.force_n(ground_.contact.contact(), held, state.proxy_mm, state.axis, velocity_, in.dt_s);
}

void Proxy::note_line() {
  using Change = touch::EnteredLine::Change;
  HapticState& state = ground_.state;
  const Change change = line_.look(state.inside, state.proxy_mm, state.axis);
  if (change == Change::began) state.events |= haptic_event::locked;
  if (change == Change::ended) state.events |= haptic_event::unlocked;
}

// Of the wall of the hole by which the tool came in, across its axis.
Vec3 Proxy::line_force(Vec3 hand_mm) const {
  if (!line_.holds()) return {};
  const cases::CaseFace& wall = ground_.feels[std::size_t(line_.shape())].front;
  const Vec3 across = velocity_ - line_.axis() * dot(velocity_, line_.axis());
  const tissue::BentShaft::Springs bent =
      bent_.at(wall.touchable ? wall.stiffness_n_per_mm : stiffest_n_per_mm_, line_.depth_mm(hand_mm));
  return off_line_mm_ * bent.across_n_per_mm + line_.axis() * (bent.along_n_per_mm2 * dot(off_line_mm_, off_line_mm_)) -
         across * (wall.touchable ? wall.damping_n_s_per_mm : 0);
}

// The torque of the surfaces' forces and of a spring from the device's orientation to the shown one. It is ramped up at
// the start as the force is.
void Proxy::set_torque(const HapticInput& in, Vec3 before) {
  HapticState& state = ground_.state;
  state.across = body_->across(in);
  Vec3 torque = pressed_n_mm_;
  if (const std::optional<Vec3> turn = body_->kept_from_turning(in))
    torque += *turn * force_.turn_stiffness_n_mm_per_rad;
  else if (line_.holds() && in.axis != Vec3{})
    torque += rotation_between(frame_along(in.axis), turned(frame_along(in.axis), line_.axis())) *
              force_.turn_stiffness_n_mm_per_rad;
  if (torque == Vec3{} && before == Vec3{}) {  // of a point, and in air
    state.torque_n_mm = torque;
    return;
  }
  if (since_s_ < force_.ramp_s) torque = torque * (since_s_ / force_.ramp_s);
  state.torque_n_mm = limited_torque(force_, torque, before, in);
}

void Proxy::note_events(const HapticState& before) {
  HapticState& state = ground_.state;
  if (before.touched != 0 && before.touched != state.touched) state.events |= haptic_event::untouch;
  if (state.touched != 0 && before.touched != state.touched) {
    state.events |= haptic_event::touch;
    moved_from_mm_ = state.proxy_mm;
  }
  if (state.touched != 0 && norm(state.proxy_mm - moved_from_mm_) > motion_mm) {
    state.events |= haptic_event::motion;
    moved_from_mm_ = state.proxy_mm;
  }
  if (before.inside != 0 && before.inside != state.inside) state.events |= haptic_event::left;
}

}  // namespace trephine::haptics
