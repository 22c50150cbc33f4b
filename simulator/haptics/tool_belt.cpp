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
    for (int n = 1; n <= voxel::haptic_max_shapes; ++n) {  // not metal beside it
      ShapeFeel& f = feels[std::size_t(n)];
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

ToolBelt::ToolBelt(const touch::FeltSpace& space, const Feels& feels, const ForceParams& force,
                   const ShaftParams& shaft, std::vector<BeltToolParams> tools, Drilling* drilling)
    : contact_(space.contact()), force_(force), tools_(std::move(tools)), drilling_(drilling), rules_(tools_.size()) {
  if (tools_.empty() || tools_.size() > belt_button::tool_mask + 1)
    throw Error(ExitCode::usage, "", "tools", "must be 1 to 16");
  int burrs = 0;
  for (const BeltToolParams& t : tools_) burrs_.push_back(t.cuts ? burrs++ : -1);
  for (const BeltToolParams& t : tools_)
    proxies_.push_back(std::make_unique<Proxy>(space, felt_by(t, feels), force, shaft, make_tool(t)));
}
ToolBelt::~ToolBelt() = default;

// Whether the tool in hand has changed.
bool ToolBelt::take(const HapticInput& in) {
  const bool free = state_.touched == 0 && state_.inside == 0;
  const auto in_shape = [&] { return contact_.shape_at(in.tip_mm) != 0; };
  const auto still_waits = [&] { return !is_finite(in.tip_mm) || putting_back() || in_shape(); };
  if (!rules_.begin(in.buttons, free, still_waits, in_shape)) return false;
  const int burr = burrs_[std::size_t(in_hand())];
  if (drilling_ && burr >= 0) drilling_->hold(burr);
  return true;
}

void ToolBelt::latch(std::uint32_t fault) {
  state_.faults |= fault;
  for (auto& p : proxies_) p->latch(fault);
}

const HapticState& ToolBelt::update(const HapticInput& given) {
  const bool before_idle = rules_.idle();
  const Vec3 sent = state_.force_n;
  const std::uint32_t faults = state_.faults;
  const bool taken = take(given), idle = rules_.idle();
  Proxy& proxy = *proxies_[std::size_t(in_hand())];
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
    if (drilling_ && tools_[std::size_t(in_hand())].cuts)
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
  const double most = force_.force_rate_n_per_s() * (in.period_s > 0 ? in.period_s : in.dt_s);
  left_n_ = size > most ? left_n_ * ((size - most) / size) : Vec3{};
  const Vec3 change = state_.force_n + left_n_ - sent;
  const double step = norm(change);
  Vec3 force = sent + (step > most ? change * (most / step) : change);
  if (const double sum = norm(force); sum > force_.max_force_n) force = force * (force_.max_force_n / sum);
  state_.force_n = force;
}

void ToolBelt::after(const HapticInput& in, const HapticState& state) {
  const BeltToolParams& tool = tools_[std::size_t(in_hand())];
  const int command = rules_.new_command(in.buttons);
  const bool works = !rules_.idle() && state.faults == 0;
  const bool pedal = works && (in.buttons & belt_button::pedal);
  if (tool.marks && pedal && state.touched != 0) {
    has_mark_ = true;
    mark_mm_ = state.proxy_mm;
  }
  rules_.end(in.buttons, state.faults == 0, can_cut());
  if (!drilling_) return;
  if (belt_command::takes_back(command) && works && !pedal)
    drilling_->take_back(command == belt_command::undo ? Drilling::Back::last : Drilling::Back::all);
  if (command == belt_command::incise && works && has_mark_) drilling_->incise_at(mark_mm_);
  HapticInput drill = in;
  drill.buttons = (tool.cuts && pedal ? Drilling::pedal : 0) | (in.buttons & haptic_button::lifted);
  drilling_->tick(drill, state);
}

void ToolBelt::follow(const HapticInput& in, const HapticState& state) {
  take(in);
  state_ = state;
  after(in, state);
}

}  // namespace trephine::haptics
