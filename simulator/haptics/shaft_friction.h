// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "contact/contact.h"
#include "haptics/feel.h"

namespace trephine::haptics {

/// Coulomb friction along a shaft that lies in tissue: a spring along the axis that slips at its limit, which is the
/// sum of the shapes' friction over the length that lies in each. The shapes are looked up at places along the shaft, a
/// few of them in each frame, so that a shaft that moves fast feels its surroundings some frames late.
class ShaftFriction {
 public:
  explicit ShaftFriction(double length_mm) : length_mm_(length_mm) {}
  void begin();
  /// The force that it takes off the hand's, along the axis. The velocity is the tip's, in mm/s.
  Vec3 force_n(const contact::ContactVolume& contact, const Feels& feels, Vec3 tip_mm, Vec3 axis, Vec3 velocity_mm_s,
               double dt_s);

 private:
  static constexpr int samples_count = 64, looks_count = 8;
  double length_mm_;
  std::uint8_t shape_[samples_count] = {};
  int next_ = 0;
  double drawn_mm_ = 0;  // along the axis since it last slipped
};

}  // namespace trephine::haptics
