// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/force_ease.h"

#include <algorithm>
#include <cmath>

namespace trephine::haptics {
namespace {

constexpr double min_s = 0.005;

// From 1 to 0, level at both ends.
double share_left(double age, double whole) { return age < whole ? 0.5 * (1 + std::cos(M_PI * age / whole)) : 0; }

}  // namespace

Vec3 ForceEase::ease(Vec3 force, double explained_n, double dt_s, double release_s) {
  if (!(release_s > 0)) return force;
  const double share_before = share_left(age_s_, takes_s_);
  const Vec3 felt_before = last_ + left_ * share_before;
  const double jump = begun_ ? norm(force - last_) : 0;
  age_s_ += dt_s;
  if (jump > max_n_per_ms * std::max(1.0, dt_s * 1000) + explained_n) {
    left_ = felt_before - force;
    // The steepest place of half a cosine is pi / 2 of its mean slope.
    takes_s_ = std::clamp(0.5 * M_PI * norm(left_) / (1000 * max_n_per_ms), min_s, std::max(min_s, release_s));
    age_s_ = dt_s;
    ++count_;
  }
  begun_ = true;
  last_ = force;
  return force + left_ * share_left(age_s_, takes_s_);
}

}  // namespace trephine::haptics
