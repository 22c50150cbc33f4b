// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/force_limits.h"

#include <algorithm>
#include <cmath>

#include "device/device.h"

namespace trephine::haptics {
namespace {

double period_of(const HapticInput& in) { return in.period_s > 0 ? std::min(in.period_s, in.dt_s) : in.dt_s; }

// The way from what the device still holds, by `most` at most. The time that passed in a stall allows no larger step,
// for the hand would feel that as a blow.
Vec3 stepped(Vec3 to, Vec3 sent, double most, const HapticInput& in) {
  const Vec3 holds = in.dt_s > 1.5 * period_of(in) ? sent * device::ForceHold().share(in.dt_s) : sent;
  const Vec3 step = to - holds;
  const double change = norm(step);
  return change <= most ? to : holds + step * (most / change);
}

}  // namespace

Vec3 limited_force(const ForceParams& limits, Vec3 force, Vec3 sent, const HapticInput& in) {
  return stepped(force, sent, limits.force_rate_n_per_s() * period_of(in), in);
}

Vec3 limited_torque(const ForceParams& limits, Vec3 torque, Vec3 sent, const HapticInput& in) {
  const double size = norm(torque), most = limits.max_torque_n_mm;
  if (!(size <= most)) torque = std::isfinite(size) ? torque * (most / size) : Vec3{};
  return stepped(torque, sent, most * limits.force_rate_n_per_s() / limits.max_force_n * period_of(in), in);
}

}  // namespace trephine::haptics
