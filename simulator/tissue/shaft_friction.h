// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstdint>

#include "contact/contact.h"

namespace trephine::tissue {

/// Coulomb friction along a shaft that lies in tissue: a spring along the axis that slips at its limit, which is the
/// sum of the shapes' friction over the length that lies in each. The shapes are looked up at places along the shaft, a
/// few of them in each frame, so that a shaft that moves fast feels its surroundings some frames late.
class ShaftFriction {
 public:
  static constexpr double stiffness_n_per_mm = 0.5;
  explicit ShaftFriction(double length_mm) : length_mm_(length_mm) {}
  void begin() {
    drawn_mm_ = 0;
    std::fill(shape_, shape_ + samples_count, std::uint8_t{0});
  }
  /// The force that it takes off the hand's, along the axis. The velocity is the tip's, in mm/s; `of(shape)`: friction
  /// of a shape for each mm.
  template <class Of>
  Vec3 force_n(const contact::ContactVolume& contact, const Of& of, Vec3 tip_mm, Vec3 axis, Vec3 velocity_mm_s,
               double dt_s) {
    if (!(length_mm_ > 0)) return {};
    const double spacing = length_mm_ / samples_count;
    for (int n = 0; n < looks_count; ++n) {
      next_ = (next_ + 1) % samples_count;
      shape_[next_] = std::uint8_t(contact.shape_at(tip_mm + axis * (spacing * (next_ + 0.5))));
    }
    double limit = 0;
    for (const std::uint8_t s : shape_) limit += of(s) * spacing;
    drawn_mm_ += dot(velocity_mm_s, axis) * dt_s;
    const double most = limit / stiffness_n_per_mm;
    drawn_mm_ = std::clamp(drawn_mm_, -most, most);
    return axis * (stiffness_n_per_mm * drawn_mm_);
  }

 private:
  static constexpr int samples_count = 64, looks_count = 8;
  double length_mm_;
  std::uint8_t shape_[samples_count] = {};
  int next_ = 0;
  double drawn_mm_ = 0;  // along the axis since it last slipped
};

}  // namespace trephine::tissue
