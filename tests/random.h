// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Random numbers that are the same everywhere.
#include <cmath>
#include <cstdint>

#include "base/vec3.h"

namespace trephine {

/// SplitMix64.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double operator()() {  // 0 to 1
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return static_cast<double>((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
  }
  double operator()(double from, double to) { return from + (to - from) * (*this)(); }
  Vec3 direction() {
    const double z = (*this)(-1, 1), a = (*this)(0, 6.283185307179586), s = std::sqrt(1 - z * z);
    return {s * std::cos(a), s * std::sin(a), z};
  }

 private:
  std::uint64_t state_;
};

}  // namespace trephine
