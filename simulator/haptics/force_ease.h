// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "base/vec3.h"

namespace trephine::haptics {

/// Keeps a force continuous where what presses gives way from one tick to the next: a membrane that pops, bone that a
/// drill breaks through, a ledge that it cuts off. What the force would jump by goes away over some milliseconds, along
/// half a cosine: as long as it takes to change by max_n_per_ms at the fastest, at least 5 ms and at most release_s.
class ForceEase {
 public:
  static constexpr double max_n_per_ms = 0.1;
  /// The force to be felt in place of `force`. `explained_n`: by how much the hand's own motion may have changed it.
  Vec3 ease(Vec3 force, double explained_n, double dt_s, double release_s);
  void reset() { *this = {}; }
  std::uint64_t count() const { return count_; }

 private:
  Vec3 last_, left_;  ///< the previous force; the jump that is being faded out, in its whole size
  double age_s_ = 0, takes_s_ = 0;
  bool begun_ = false;
  std::uint64_t count_ = 0;
};

}  // namespace trephine::haptics
