// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace trephine::haptics {

/// Durations in bins of 3 %, from 1 ns to 100 s. A servo loop may call add().
class Histogram {
 public:
  void add(double ns) {
    ns = std::max(0.0, ns);
    ++bins_[std::size_t(std::clamp(int(std::log(std::max(1.0, ns)) * per_e), 0, int(bins_.size()) - 1))];
    ++count_;
    sum_ += ns;
    max_ = std::max(max_, ns);
  }
  std::uint64_t count() const { return count_; }
  double mean_ns() const { return count_ > 0 ? sum_ / double(count_) : 0; }
  double max_ns() const { return max_; }
  /// The duration below which that share of all durations lies: the upper end of its bin, at most the largest.
  double quantile_ns(double share) const {
    std::uint64_t below = 0;
    for (std::size_t n = 0; n < bins_.size(); ++n) {
      below += bins_[n];
      if (double(below) >= share * double(count_) && below > 0) return std::min(max_, std::exp(double(n + 1) / per_e));
    }
    return max_;
  }

 private:
  static constexpr double per_e = 33;
  std::array<std::uint64_t, 840> bins_{};
  std::uint64_t count_ = 0;
  double sum_ = 0, max_ = 0;
};

}  // namespace trephine::haptics
