// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>

#include "base/vec3.h"

namespace trephine::haptics {

/// Keeps a device with a delay from giving energy to the hand: the passivity observer and controller in the time domain
/// of [Hannaford2002], with two changes that a delay asks for. The observer counts each force against the motion that
/// is seen when it acts, a delay after it was sent. The controller adds no damping, for a damper behind a delay gives
/// energy as well: it lets so much of the force through as what the hand has put in can pay for, whatever the hand does
/// until the force has acted: move on or turn as fast as it lately moved, and a little faster.
///
/// Equal inputs give equal bits; it allocates only in its constructor.
class Passivity {
 public:
  /// spare_j: energy that the hand may get in advance. forgiven_w: how fast a debt is dropped.
  static constexpr double spare_j = 0.6e-3, forgiven_w = 0.1e-3;
  /// Acceleration that the prediction of the hand's motion allows for.
  static constexpr double spare_m_per_s2 = 75;

  /// From the hand's motion to the force that answers it.
  explicit Passivity(double delay_s) : delay_s_(delay_s) {}
  /// The share of `wanted_n` that may be sent, with the device at `tip_mm`. `placed`: the tool was placed anew.
  double allow(Vec3 tip_mm, Vec3 wanted_n, double dt_s, double period_s, bool placed);
  /// What the hand was given less what it put in, as far as that is remembered.
  double given_j() const { return 1e-3 * given_n_mm_; }

 private:
  static constexpr std::size_t kept = 1024;  // ticks
  static constexpr double let_in_s = 0.02, max_credit_n_mm = 20;
  static constexpr double part_s = 0.01;
  static constexpr std::size_t parts = 15;
  void observe(Vec3 step_mm, double period_s);
  Vec3& sent(std::size_t ago) { return sent_[(now_ + kept - ago) % kept]; }
  void remember(double mm_per_s, double dt_s);

  const double delay_s_;
  std::array<Vec3, kept> sent_{};        // by tick
  std::array<double, parts> fastest_{};  // mm/s, of each part_s, the first of the newest
  double part_age_s_ = 0;
  std::size_t now_ = 0;
  Vec3 tip_mm_;
  bool known_ = false;
  double given_n_mm_ = 0, share_ = 1;
};

}  // namespace trephine::haptics
