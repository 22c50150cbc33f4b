// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/vec3.h"

namespace trephine::surface {

/// A list of places on float32's raster, stored coordinate by coordinate for quick searches.
class PlaceList {
 public:
  void clear() { size_ = 0; }
  void add(Vec3 p) {
    if (size_ % block == 0) {  // a whole number of blocks; places beyond the size are far away
      if (size_ == x_.size())
        for (auto* v : {&x_, &y_, &z_}) v->resize(size_ + block);
      std::fill_n(x_.begin() + static_cast<std::ptrdiff_t>(size_), block, far);
    }
    x_[size_] = static_cast<float>(p.x);
    y_[size_] = static_cast<float>(p.y);
    z_[size_] = static_cast<float>(p.z);
    ++size_;
  }
  std::size_t size() const { return size_; }
  Vec3 at(std::size_t n) const { return {x_[n], y_[n], z_[n]}; }

  /// The number of the place nearest to p, to float32's precision, or of any place that is certainly nearer than the
  /// root of `enough`. `hint` is the number of a place that is likely near, such as the answer for a point beside p: it
  /// only saves time. The list must not be empty.
  std::size_t nearest(Vec3 p, double enough, bool& certainly, std::size_t hint = 0) const {
    const float px = static_cast<float>(p.x), py = static_cast<float>(p.y), pz = static_cast<float>(p.z);
    const float sure = static_cast<float>(enough * 0.99);
    if (squared(hint, px, py, pz) <= sure) {
      certainly = true;
      return hint;
    }
    float best = std::numeric_limits<float>::infinity();
    std::size_t where = 0;
    for (std::size_t n = 0; n < size_; n += block) {
      std::array<float, block> d2;
      std::array<float, 4> low;
      const float *x = &x_[n], *y = &y_[n], *z = &z_[n];
      for (std::size_t i = 0; i < block; ++i)
        d2[i] = (x[i] - px) * (x[i] - px) + (y[i] - py) * (y[i] - py) + (z[i] - pz) * (z[i] - pz);
      for (std::size_t i = 0; i < 4; ++i)
        low[i] = std::min(std::min(d2[i], d2[i + 4]), std::min(d2[i + 8], d2[i + 12]));
      const float least = std::min(std::min(low[0], low[1]), std::min(low[2], low[3]));
      if (!(least < best)) continue;
      best = least;
      where = n;
      if (best <= sure) break;
    }
    certainly = best <= sure;
    for (std::size_t i = where; i < std::min(where + block, size_); ++i)
      if (squared(i, px, py, pz) == best) return i;
    return where;
  }

 private:
  float squared(std::size_t i, float px, float py, float pz) const {
    return (x_[i] - px) * (x_[i] - px) + (y_[i] - py) * (y_[i] - py) + (z_[i] - pz) * (z_[i] - pz);
  }
  static constexpr std::size_t block = 16;
  static constexpr float far = 1e18f;
  std::size_t size_ = 0;
  std::vector<float> x_, y_, z_;
};

}  // namespace trephine::surface
