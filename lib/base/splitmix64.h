// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

namespace trephine {

/// The random number generator SplitMix64 [Steele2014]. The generator adds the step to its state and returns the mixed
/// state. Mixing the multiples of the step by a counter gives random numbers as well: the number that belongs to a
/// count is the same whatever the order or the thread that asks.
constexpr std::uint64_t splitmix64_step = 0x9e3779b97f4a7c15u;
constexpr std::uint64_t splitmix64_mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}
/// A number in [0, 1) from the upper 53 bits.
constexpr double unit_of_bits(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

}  // namespace trephine
