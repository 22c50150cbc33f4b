// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/simulated_hand.h"

#include <algorithm>
#include <cmath>

namespace trephine::device {

double ForceHold::share(double age_s) const {
  if (age_s <= hold_s) return 1;
  return decay_s > 0 ? std::exp((hold_s - age_s) / decay_s) : 0;
}

void add_tremor(const HandParams& params, double time_s, Vec3& p) {
  for (int a = 0; a < 3; ++a)
    for (int n = 0; n < 3; ++n)
      p[a] += params.tremor_mm / 3 *
              std::sin(2 * M_PI * params.tremor_hz * (1 + 0.13 * (n - 1)) * time_s + 1.7 * a + 2.3 * n);
}

void HandBody::pull(const HandParams& params, const ForceHold& hold, Vec3 to, double part_s) {
  const double damping_n_s_per_mm = params.arm_damping_n_s_per_mm + params.device_damping_n_s_per_mm;
  // An explicit step diverges where damping would turn the velocity of a light hand round.
  const double max_step_s = std::min(2e-5, 0.2 * params.mass_kg / (1000 * std::max(damping_n_s_per_mm, 1e-9)));
  const int steps = std::max(32, int(std::ceil(part_s / max_step_s)));
  const double h = part_s / steps;
  for (int n = 0; n < steps; ++n) {
    force_age_s += h;
    const double share = force_age_s <= hold.hold_s ? 1 : hold.share(force_age_s);
    const Vec3 force =
        force_n * share + (to - position_mm) * params.arm_stiffness_n_per_mm - velocity * damping_n_s_per_mm;
    velocity += force * (1000 * h / params.mass_kg);  // N / kg are m / s^2
    position_mm += velocity * h;
  }
}

SimulatedHand::SimulatedHand(const HandParams& params, std::vector<Vec3> path_mm, std::size_t loop_from)
    : params_(params), path_mm_(std::move(path_mm)) {
  length_mm_.push_back(0);
  for (std::size_t n = 1; n < path_mm_.size(); ++n)
    length_mm_.push_back(length_mm_.back() + norm(path_mm_[n] - path_mm_[n - 1]));
  loop_begin_mm_ = length_mm_[std::min(loop_from, path_mm_.size() - 1)];
  body_.position_mm = path_mm_.front();
}

// The path at that time, and the tremor.
Vec3 SimulatedHand::aim(double path_s, double time_s) const {
  const double end = length_mm_.back(), loop = end - loop_begin_mm_;
  double at = std::max(0.0, path_s) * params_.speed_mm_per_s;
  if (at > end) at = loop > 0 ? loop_begin_mm_ + std::fmod(at - loop_begin_mm_, loop) : end;
  const auto after = std::upper_bound(length_mm_.begin(), length_mm_.end(), at);
  Vec3 p = path_mm_.back();
  if (after != length_mm_.end()) {
    const std::size_t n = std::size_t(after - length_mm_.begin());
    const double span = length_mm_[n] - length_mm_[n - 1];
    p = path_mm_[n - 1] + (path_mm_[n] - path_mm_[n - 1]) * (span > 0 ? (at - length_mm_[n - 1]) / span : 0);
  }
  add_tremor(params_, time_s, p);
  return p;
}

// Where something is touched, the arm presses along the tool with press_n, as deep as its path goes at most.
Vec3 SimulatedHand::pressed(Vec3 on_path) const {
  const double stiffness = params_.arm_stiffness_n_per_mm, deeper_mm = dot(body_.position_mm - path_mm_.back(), axis);
  if (!(press_n > 0) || !(stiffness > 0) || norm(body_.force_n) == 0 || deeper_mm <= 0) return on_path;
  return on_path + axis * (dot(body_.position_mm - on_path, axis) - press_n / stiffness);
}

bool SimulatedHand::read(double dt_s, DeviceReading& out) {
  // The aim a millisecond at a time, the mass in steps that are fine beside the servo's own.
  for (double left = std::clamp(dt_s, 0.0, 10.0); left > 0;) {
    const double part = std::min(left, 0.001);
    left -= part;
    time_s_ += part;
    const auto on_path = [&] { return aim(path_s_ - params_.delay_s, time_s_ - params_.delay_s); };
    const double most_n = press_n > 0 ? press_n : feed_force_n;
    // Where it presses, what counts is the pull across the tool.
    const Vec3 off = on_path() - body_.position_mm, across = press_n > 0 ? off - axis * dot(off, axis) : off;
    if (!(most_n > 0) || norm(across) * params_.arm_stiffness_n_per_mm <= most_n) path_s_ += part;
    body_.pull(params_, hold, pressed(on_path()), part);
  }
  out = {};
  out.tip_mm = body_.position_mm;
  out.axis = axis;
  if (drills) out.buttons = time_s_ < 0.02 ? 2 : 1;
  return is_finite(body_.position_mm);
}

void SimulatedHand::send(Vec3 force_n) { body_.feel(force_n); }

}  // namespace trephine::device
