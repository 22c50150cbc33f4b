// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/force_slew.h"

#include <algorithm>
#include <cmath>

namespace trephine::haptics {

void ForceSlew::reset() {
  felt_ = {};
  age_s_ = -1;
  behind_ = begun_ = false;
}

// How much of the change is felt after that share of an event's time.
double ForceSlew::share(double t) const {
  switch (shape_) {
    case ForceParams::Shape::line:
      return t;
    case ForceParams::Shape::snap:
      return 1 - (1 - t) * (1 - t) * (1 - t);
    case ForceParams::Shape::cosine:
      break;
  }
  return 0.5 * (1 - std::cos(M_PI * t));
}

Vec3 ForceSlew::follow(Vec3 force, bool drilling, bool event, double explained_n, double dt_s) {
  const bool held = begun_ && (drilling || behind_ || age_s_ >= 0);
  begun_ = true;
  if (event && held) {
    from_ = felt_;
    age_s_ = 0;
  }
  if (!held) return felt_ = force;
  if (age_s_ >= 0) {
    age_s_ += dt_s;
    if (age_s_ < event_s_) return felt_ = from_ + (force - from_) * share(age_s_ / event_s_);
    age_s_ = -1;
    behind_ = true;
  }
  const Vec3 step = force - felt_;
  const double most = std::max(max_n_per_ms * 1000 * dt_s, explained_n);
  const double size = norm(step);
  behind_ = size > most;
  return felt_ = behind_ ? felt_ + step * (most / size) : force;
}

}  // namespace trephine::haptics
