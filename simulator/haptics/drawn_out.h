// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "haptics/tool.h"

namespace trephine::haptics {

/// Whether a device draws its tool outwards along its axis and it does not come: then no lock may hold it in its hole,
/// and where it is jammed aslant it is shaken loose as a hand would do it.
class DrawnOut {
 public:
  explicit DrawnOut(double tool_length_mm) : length_mm_(tool_length_mm) {}
  /// In each frame: how far the device is behind the tool.
  void note(Vec3 behind_mm, Vec3 axis);
  bool draws_out() const;
  /// How many places are tried in this frame: more where it took long already.
  int tries() const;
  struct Place {
    Mat3 frame;
    Vec3 way_mm;  ///< of the tip
  };
  /// A place close by, a little further out: the tool is shifted across its axis and tilted about a place of its shaft,
  /// each time another way.
  Place next(const Mat3& frame, double step_mm);

 private:
  double length_mm_;
  int drawn_for_ = 0;  // frames
  int tried_ = 0;
};

}  // namespace trephine::haptics
