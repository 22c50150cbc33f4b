// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <vector>

#include "base/rank.h"

namespace trephine::track {

/// Those that are off by no more than three standard deviations, which their median says; `least_scale_mm` is the
/// smallest of these. `off` is 0 or more for each.
template <class T>
std::vector<T> inliers(const std::vector<T>& all, const std::vector<double>& off, double least_scale_mm) {
  constexpr double of_median = 1.4826, deviations = 3;
  const double most = deviations * std::max(least_scale_mm, of_median * median_of(std::vector<double>(off)));
  std::vector<T> kept;
  for (std::size_t n = 0; n < all.size(); ++n)
    if (off[n] <= most) kept.push_back(all[n]);
  return kept;
}

}  // namespace trephine::track
