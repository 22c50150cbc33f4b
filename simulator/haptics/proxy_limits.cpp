// SPDX-License-Identifier: GPL-3.0-or-later
// What a device may be asked for: how fast forces and torques change, and how large torques are.
#include <algorithm>
#include <cmath>

#include "device/device.h"
#include "haptics/proxy.h"

namespace trephine::haptics {

// The force may change from what the device holds by what the rate allows in one period. After a stall the device holds
// less than it was sent. The time that passed allows no larger step, for the hand would feel that as a blow.
Vec3 Proxy::limited(Vec3 force, Vec3 sent, const HapticInput& in) const {
  const double period = in.period_s > 0 ? std::min(in.period_s, in.dt_s) : in.dt_s;
  const bool stalled = in.dt_s > 1.5 * period;
  const Vec3 holds = stalled ? sent * device::ForceHold().share(in.dt_s) : sent, step = force - holds;
  const double change = norm(step), most = force_.max_force_rate_n_per_s * period;
  return change <= most ? force : holds + step * (most / change);
}

// The torque of the surfaces' forces and of a spring from the device's orientation to the shown one. It is ramped up at
// the start, and limited in size and in rate as the force is.
void Proxy::set_torque(const HapticInput& in, Vec3 before) {
  state_.across = body_ ? body_->frame().column[0] : in.across;
  Vec3 torque = pressed_n_mm_;
  if (body_ && in.axis != Vec3{}) {
    const Mat3 aim = in.across == Vec3{} ? turned(body_->frame(), in.axis) : frame_of(in.axis, in.across);
    torque += rotation_between(aim, body_->frame()) * force_.turn_stiffness_n_mm_per_rad;
  } else if (round_ && !(state_.axis == in.axis)) {
    const Mat3 aim = frame_along(in.axis);
    torque += rotation_between(aim, turned(aim, state_.axis)) * force_.turn_stiffness_n_mm_per_rad;
  }
  if (torque == Vec3{} && before == Vec3{}) {  // of a point, and in air
    state_.torque_n_mm = torque;
    return;
  }
  if (since_s_ < force_.ramp_s) torque = torque * (since_s_ / force_.ramp_s);
  const double size = norm(torque), most = force_.max_torque_n_mm;
  if (!(size <= most)) torque = std::isfinite(size) ? torque * (most / size) : Vec3{};
  const double period = in.period_s > 0 ? std::min(in.period_s, in.dt_s) : in.dt_s;
  const Vec3 holds = in.dt_s > 1.5 * period ? before * device::ForceHold().share(in.dt_s) : before,
             step = torque - holds;
  const double change = norm(step), allowed = most * force_.max_force_rate_n_per_s / force_.max_force_n * period;
  state_.torque_n_mm = change <= allowed ? torque : holds + step * (allowed / change);
}

}  // namespace trephine::haptics
