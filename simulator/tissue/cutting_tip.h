// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>

#include "base/vec3.h"

namespace trephine::tissue {

/// The force on a tip that cuts its way on through tissue, apart from what holds its shaft [Okamura2004]: a spring
/// along the axis that gives way at the tissue's limit. A tip that is drawn back meets nothing, once the spring is let
/// go.
class CuttingTip {
 public:
  static constexpr double stiffness_n_per_mm = 0.5;
  void begin() { pressed_mm_ = 0; }
  /// On the hand. The axis points from the tip to the tail.
  Vec3 force_n(double limit_n, Vec3 axis, Vec3 velocity_mm_s, double dt_s) {
    if (!(limit_n > 0)) {
      pressed_mm_ = 0;
      return {};
    }
    pressed_mm_ = std::clamp(pressed_mm_ - dot(velocity_mm_s, axis) * dt_s, 0.0, limit_n / stiffness_n_per_mm);
    return axis * (stiffness_n_per_mm * pressed_mm_);
  }

 private:
  double pressed_mm_ = 0;
};

}  // namespace trephine::tissue
