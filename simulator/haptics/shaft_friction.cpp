// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/shaft_friction.h"

#include <algorithm>

namespace trephine::haptics {

void ShaftFriction::begin() {
  drawn_mm_ = 0;
  std::fill(shape_, shape_ + samples_count, std::uint8_t{0});
}

Vec3 ShaftFriction::force_n(const contact::ContactVolume& contact, const Feels& feels, Vec3 tip, Vec3 axis,
                            Vec3 velocity, double dt_s) {
  constexpr double stiffness_n_per_mm = 0.5;
  if (!(length_mm_ > 0)) return {};
  const double spacing = length_mm_ / samples_count;
  for (int n = 0; n < looks_count; ++n) {
    next_ = (next_ + 1) % samples_count;
    shape_[next_] = std::uint8_t(contact.shape_at(tip + axis * (spacing * (next_ + 0.5))));
  }
  double limit = 0;
  for (const std::uint8_t s : shape_) limit += feels[s].shaft_friction_n_per_mm * spacing;
  drawn_mm_ += dot(velocity, axis) * dt_s;
  const double most = limit / stiffness_n_per_mm;
  drawn_mm_ = std::clamp(drawn_mm_, -most, most);
  return axis * (stiffness_n_per_mm * drawn_mm_);
}

}  // namespace trephine::haptics
