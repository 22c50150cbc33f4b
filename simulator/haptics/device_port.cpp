// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/device_port.h"

#include <algorithm>

#include "haptics/tool_belt.h"

namespace trephine::haptics {
namespace {

constexpr double min_pose_s = 0.005, max_pose_s = 0.01;
// What a silent device still says: the tool in hand, and that it is lifted.
constexpr std::uint32_t kept_buttons = haptic_button::lifted | belt_button::tool_mask << belt_button::tool_shift;

}  // namespace

DevicePort::DevicePort(const PortParams& params, const ForceParams& force, const FreeParams& free)
    : params_(params), force_(force), back_s_(params.let_in_s) {
  if (params.device_delay_ms > 0 && !params.bounds_walls()) passivity_.emplace(1e-3 * params.device_delay_ms);
  if (free.any()) free_.emplace(free, force.velocity_cutoff_hz);
}

void DevicePort::before(HapticInput& in, bool silent) {
  passing_ = 0;
  if (silent) {
    passing_ = haptic_fault::gap;
    in.buttons &= kept_buttons;
    if (!silent_) gaps_.fetch_add(1, std::memory_order_relaxed);
  } else {
    look(in);
  }
  silent_ = silent;
  if (free_) in.extra_n += free_->force_n(in);
}

void DevicePort::again(HapticInput& in, std::uint32_t faults) {
  if (faults & haptic_fault::jump) in.buttons &= ~haptic_button::lifted;
  before(in, faults & haptic_fault::gap);
}

void DevicePort::look(HapticInput& in) {
  if (!(params_.jump_m_per_s > 0)) return;
  since_s_ += in.dt_s;
  const double way_mm = norm(in.tip_mm - last_mm_);
  bool placed = in.buttons & haptic_button::lifted;
  if (known_ && !placed && is_finite(in.tip_mm)) {
    const double since_s = silent_ ? max_pose_s : std::clamp(since_s_, min_pose_s, max_pose_s);
    if (way_mm > 1000 * params_.jump_m_per_s * std::max(since_s, in.dt_s)) {
      in.buttons |= haptic_button::lifted;
      placed = silent_;  // a hand may have done that in the gap
      if (!silent_) {
        passing_ = haptic_fault::jump;
        jumps_.fetch_add(1, std::memory_order_relaxed);
      }
    }
  }
  if (!known_ || way_mm != 0) since_s_ = 0;
  last_mm_ = in.tip_mm;
  known_ = !placed && is_finite(in.tip_mm);
}

const HapticState& DevicePort::after(const HapticInput& in, const HapticState& state) {
  if (passing_ == 0 && back_s_ >= params_.let_in_s && !passivity_) {
    sent_n_ = state.force_n;
    return state;
  }
  const double period_s = in.period_s > 0 ? in.period_s : in.dt_s;
  state_ = state;
  state_.faults |= passing_;
  double share = 1;
  if (passing_ != 0) {
    back_s_ = share = 0;
  } else if (back_s_ < params_.let_in_s) {
    back_s_ += in.dt_s;
    share = std::min(1.0, back_s_ / params_.let_in_s);
  }
  Vec3 force = share > 0 ? state.force_n * share : Vec3{};
  if (share > 0 && share < 1) {  // while it comes back, too, the force changes no faster than it may
    const Vec3 step = force - sent_n_;
    const double change = norm(step), most = force_.force_rate_n_per_s() * period_s;
    if (change > most) force = sent_n_ + step * (most / change);
  }
  if (passivity_ && state.faults == 0) {
    const double allowed = passivity_->allow(in.tip_mm, force, in.dt_s, period_s, in.buttons & haptic_button::lifted);
    force = force * allowed;
    share *= allowed;
  }
  state_.force_n = sent_n_ = force;
  state_.torque_n_mm = share > 0 ? state.torque_n_mm * share : Vec3{};
  return state_;
}

}  // namespace trephine::haptics
