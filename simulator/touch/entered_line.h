// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "base/vec3.h"

namespace trephine::touch {

/// The line locking of [Rizzi, 5.5.1]: a tool whose tip has entered one of these shapes (bit n: shape n), such as bone
/// or brain, keeps its orientation and moves along its own axis alone, on the line by which it came in, until its tip
/// has left them.
class EnteredLine {
 public:
  explicit EnteredLine(std::uint64_t shapes) : shapes_(shapes) {}
  void reset() { shape_ = 0; }
  bool holds() const { return shape_ != 0; }
  int shape() const { return shape_; }  ///< in which the tip is; 0 where nothing is held
  Vec3 axis() const { return axis_; }
  /// The place of the line that is nearest to the hand.
  Vec3 nearest_to(Vec3 hand_mm) const { return through_mm_ + axis_ * dot(hand_mm - through_mm_, axis_); }

  /// How deep a tip is along the line; below 0 where it was drawn back beyond where it entered.
  double depth_mm(Vec3 tip_mm) const { return dot(through_mm_ - tip_mm, axis_); }

  enum class Change { none, began, ended };
  /// The tip as it is shown after a tick, and what it is in. A tool that begins inside is held where it begins.
  Change look(int inside, Vec3 tip_mm, Vec3 axis) {
    const bool held = holds(), in = inside != 0 && (shapes_ >> inside & 1);
    shape_ = in ? inside : 0;
    if (in == held) return Change::none;
    if (in) {
      through_mm_ = tip_mm;
      axis_ = normalized(axis);
    }
    return in ? Change::began : Change::ended;
  }

 private:
  std::uint64_t shapes_;
  int shape_ = 0;
  Vec3 through_mm_, axis_{0, 0, 1};
};

}  // namespace trephine::touch
