// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/tool_belt.h"

#include <algorithm>

#include "base/error.h"

namespace trephine::haptics {
namespace {

// How a needle feels within what it pierced; the values are ours. It moves against drag, and stays when it is let go.
constexpr double pierced_drag_n_s_per_mm = 0.03, pierced_friction_n_per_mm = 0.005;

Feels felt_by(const BeltToolParams& tool, Feels feels) {
  if (tool.pierce_n > 0)
    for (ShapeFeel& f : feels) {
      if (!f.front.touchable || f.front.pop_through_n > 0) continue;
      f.front.pop_through_n = tool.pierce_n;
      if (f.back.touchable) f.back.pop_through_n = tool.pierce_n;
      f.drag_n_s_per_mm = std::max(f.drag_n_s_per_mm, pierced_drag_n_s_per_mm);
      f.shaft_friction_n_per_mm = std::max(f.shaft_friction_n_per_mm, pierced_friction_n_per_mm);
    }
  if (tool.blunt)
    for (ShapeFeel& f : feels) f.front.pop_through_n = f.back.pop_through_n = 0;
  return feels;
}

}  // namespace

ToolBelt::ToolBelt(const contact::ContactVolume& contact, const Feels& feels, const ForceParams& force,
                   const ShaftParams& shaft, std::vector<BeltToolParams> tools, Drilling* drilling, bool in_open)
    : contact_(contact), force_(force), tools_(std::move(tools)), drilling_(drilling), in_open_(in_open) {
  if (tools_.empty() || tools_.size() > belt_button::tool_mask + 1)
    throw Error(ExitCode::usage, "", "tools", "must be 1 to 16");
  int burrs = 0;
  for (const BeltToolParams& t : tools_) burrs_.push_back(t.cuts ? burrs++ : -1);
  for (const BeltToolParams& t : tools_)
    proxies_.push_back(std::make_unique<Proxy>(contact, felt_by(t, feels), force, shaft, make_tool(t)));
}
ToolBelt::~ToolBelt() = default;

// Whether the tool in hand has changed. A number that no tool has changes nothing.
bool ToolBelt::take(const HapticInput& in) {
  const int n = belt_button::tool(in.buttons);
  const int to = n < int(tools_.size()) ? n : std::max(0, in_hand_);
  if (to == in_hand_) return false;
  const bool idle = paused_ || waiting_ || in_hand_ < 0;  // nothing is felt, and the tool may be anywhere
  if (in_open_ && !idle && (state_.touched != 0 || state_.inside != 0 || contact_.shape_at(in.tip_mm) != 0))
    return false;
  in_hand_ = to;
  if (const int burr = burrs_[std::size_t(to)]; drilling_ && burr >= 0) drilling_->hold(burr);
  return true;
}

// A hand that begins, or comes again, does so outside of every shape: no tissue would have held it on its way in.
void ToolBelt::look_outside(const HapticInput& in) {
  if (!in_open_) return;
  if (paused_ || (in.buttons & haptic_button::lifted))
    waiting_ = true;
  else if (waiting_ && is_finite(in.tip_mm))
    waiting_ = putting_back() || contact_.shape_at(in.tip_mm) != 0;
}

int ToolBelt::new_command(std::uint32_t buttons) const {
  const int command = belt_button::command(buttons);
  return command == belt_button::command(buttons_) ? belt_command::none : command;
}

void ToolBelt::latch(std::uint32_t fault) {
  state_.faults |= fault;
  for (auto& p : proxies_) p->latch(fault);
}

const HapticState& ToolBelt::update(const HapticInput& given) {
  const bool before_idle = paused_ || waiting_;
  const int command = new_command(given.buttons);
  if (command == belt_command::resume) paused_ = false;
  if (command == belt_command::pause && state_.touched == 0 && state_.inside == 0) paused_ = true;

  const Vec3 sent = state_.force_n;
  const std::uint32_t faults = state_.faults;
  look_outside(given);
  const bool taken = take(given), idle = paused_ || waiting_;
  Proxy& proxy = *proxies_[std::size_t(in_hand_)];
  if (taken || (before_idle && !idle)) {
    proxy.reset();
    left_n_ = sent;
  }
  if (idle) {
    state_ = {};
    state_.proxy_mm = given.tip_mm;
    state_.axis = given.axis;
    state_.across = usable_across(given.across, given.axis);
    if (!before_idle) left_n_ = sent;
    if (faults != 0) proxy.latch(faults);
    state_.faults = faults;
  } else {
    if (faults != 0) proxy.latch(faults);
    HapticInput in = given;
    if (drilling_ && tools_[std::size_t(in_hand_)].cuts)
      drilling_->prepare(in);
    else
      in.away = drilling_ && drilling_->putting_back();
    state_ = proxy.update(in);
  }
  settle_force(given, sent);
  return state_;
}

// The force of a tool that was put down falls as fast as a force may change; the sum keeps to that limit as well.
void ToolBelt::settle_force(const HapticInput& in, Vec3 sent) {
  if (state_.faults != 0) {
    left_n_ = state_.force_n = {};
    return;
  }
  const double size = norm(left_n_);
  if (!(size > 0)) return;
  const double most = force_.max_force_rate_n_per_s * (in.period_s > 0 ? in.period_s : in.dt_s);
  left_n_ = size > most ? left_n_ * ((size - most) / size) : Vec3{};
  const Vec3 change = state_.force_n + left_n_ - sent;
  const double step = norm(change);
  Vec3 force = sent + (step > most ? change * (most / step) : change);
  if (const double sum = norm(force); sum > force_.max_force_n) force = force * (force_.max_force_n / sum);
  state_.force_n = force;
}

void ToolBelt::after(const HapticInput& in, const HapticState& state) {
  const BeltToolParams& tool = tools_[std::size_t(in_hand_)];
  const int command = new_command(in.buttons);
  buttons_ = in.buttons;
  const bool works = !paused_ && !waiting_ && state.faults == 0;
  const bool pedal = works && (in.buttons & belt_button::pedal);
  if (tool.marks && pedal && state.touched != 0) {
    has_mark_ = true;
    mark_mm_ = state.proxy_mm;
  }
  const bool back = command == belt_command::undo || command == belt_command::reset;
  if (back && works && !pedal && can_cut()) waiting_ = waiting_ || in_open_;
  if (!drilling_) return;
  if (back && works && !pedal)
    drilling_->take_back(command == belt_command::undo ? Drilling::Back::last : Drilling::Back::all);
  if (command == belt_command::incise && works && has_mark_) drilling_->incise_at(mark_mm_);
  HapticInput drill = in;
  drill.buttons = (tool.cuts && pedal ? Drilling::pedal : 0) | (in.buttons & haptic_button::lifted);
  drilling_->tick(drill, state);
}

void ToolBelt::follow(const HapticInput& in, const HapticState& state) {
  const int command = new_command(in.buttons);
  if (command == belt_command::resume) paused_ = false;
  if (command == belt_command::pause && state_.touched == 0 && state_.inside == 0) paused_ = true;
  look_outside(in);
  take(in);
  state_ = state;
  after(in, state);
}

}  // namespace trephine::haptics
