// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <cstdint>

#include "base/pi.h"
#include "base/splitmix64.h"

namespace trephine::phantom {

/// Random numbers as a function of (seed, stream, index): the same whatever the order or the thread that asks.
/// The mixer is SplitMix64's, applied once per word.
inline std::uint64_t mixed(std::uint64_t z) { return splitmix64_mixed(z + splitmix64_step); }
inline std::uint64_t random_bits(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return mixed(mixed(mixed(seed) + stream) + index);
}
/// In [-1, 1).
inline double uniform(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return static_cast<double>(random_bits(seed, stream, index) >> 11) * 0x1p-52 - 1;
}
/// Standard normal numbers [Box1958], two for each call.
inline void normal_pair(std::uint64_t seed, std::uint64_t stream, std::uint64_t index, float& a, float& b) {
  const std::uint64_t bits = random_bits(seed, stream, index);
  const float u = (static_cast<float>(bits >> 40) + 0.5f) * 0x1p-24f;
  const float angle = static_cast<float>((bits >> 8) & 0xffffff) * (float(2 * pi) * 0x1p-24f);
  const float radius = std::sqrt(-2 * std::log(u));
  a = radius * std::cos(angle);
  b = radius * std::sin(angle);
}

}  // namespace trephine::phantom
