// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Random numbers that are the same everywhere.
#include <cmath>
#include <cstdint>

#include "base/pi.h"
#include "base/splitmix64.h"
#include "base/vec3.h"

namespace trephine {

/// SplitMix64.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double operator()() { return unit_of_bits(splitmix64_mixed(state_ += splitmix64_step)); }  // 0 to 1
  double operator()(double from, double to) { return from + (to - from) * (*this)(); }
  Vec3 direction() {
    const double z = (*this)(-1, 1), a = (*this)(0, 2 * pi), s = std::sqrt(1 - z * z);
    return {s * std::cos(a), s * std::sin(a), z};
  }

 private:
  std::uint64_t state_;
};

}  // namespace trephine
