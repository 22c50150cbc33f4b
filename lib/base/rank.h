// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>

namespace trephine {

/// The value that would stand at that place, from 0, if the values were sorted. Reorders them; they may not be fewer.
template <class Values>
auto value_at_rank(Values&& values, std::size_t rank) {
  const auto at = values.begin() + std::ptrdiff_t(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The median, of an even number of values the upper one. Reorders them; there is at least one.
template <class Values>
auto median_of(Values&& values) {
  return value_at_rank(values, values.size() / 2);
}

}  // namespace trephine
