// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/free_feel.h"

#include <cmath>

#include "base/error.h"

namespace trephine::haptics {
namespace {

Vec3 vec(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

}  // namespace

FreeFeel::FreeFeel(const FreeParams& params, double cutoff_hz)
    : params_(params),
      slowness_s_(cutoff_hz > 0 ? 1 / (2 * M_PI * cutoff_hz) : 0),
      along_(normalized(vec(params.guide_along))) {
  if (params.guide != FreeParams::Guide::none && along_ == Vec3{})
    throw Error(ExitCode::usage, "", "--guide-along", "must have a length");
}

Vec3 FreeFeel::force_n(const HapticInput& in) {
  const bool placed = in.buttons & haptic_button::lifted;
  if (known_ && !placed)
    velocity_ += ((in.tip_mm - last_mm_) / in.dt_s - velocity_) * (in.dt_s / (in.dt_s + slowness_s_));
  else
    velocity_ = {};
  last_mm_ = in.tip_mm;
  known_ = !placed && is_finite(in.tip_mm);
  Vec3 force = velocity_ * -params_.viscosity_n_s_per_mm - vec(params_.weight_n);
  if (params_.guide == FreeParams::Guide::none) return force;
  const Vec3 off = in.tip_mm - vec(params_.guide_point_mm), along = along_ * dot(off, along_);
  const Vec3 back = (params_.guide == FreeParams::Guide::line ? along - off : along * -1.0) * params_.guide_n_per_mm;
  const double size = norm(back);
  return force + (size > params_.guide_most_n ? back * (params_.guide_most_n / size) : back);
}

}  // namespace trephine::haptics
