// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/vec3.h"

namespace trephine::touch {

/// The search of a place next to a shape that nothing enters, for a tool that starts within it: ever farther, at each
/// distance along the tool's axis first and then towards the faces, edges and corners of a cube. It goes on in the next
/// frame where it stopped.
class WayOut {
 public:
  static constexpr double farthest_mm = 60;
  static constexpr int ways = 27;
  static Vec3 way(int n) {  ///< unit; zero for the one in the middle
    return normalized(Vec3{double(n % 3 - 1), double(n / 3 % 3 - 1), double(n / 9 - 1)});
  }
  bool exhausted() const { return !(mm_ < farthest_mm); }
  /// From where the tool is to the next place to be looked at; zero: none in this step.
  Vec3 next_mm(Vec3 axis) {
    const Vec3 to = (next_ < 0 ? axis : way(next_)) * mm_;
    if (++next_ == ways) {
      next_ = -1;
      mm_ *= 1.25;
    }
    return to;
  }

 private:
  double mm_ = 0.1;
  int next_ = -1;  // the direction to be examined next; -1: along the axis
};

}  // namespace trephine::touch
