// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/drawn_out.h"

#include <algorithm>
#include <cmath>

namespace trephine::haptics {
namespace {

constexpr double drawn_out_mm = 0.3, tilt_rad_at_most = 0.02;
constexpr int drawn_frames = 5;

}  // namespace

// Counts the frames in which the device is so far behind the tool, on its tail's side.
void DrawnOut::note(Vec3 behind_mm, Vec3 axis) {
  drawn_for_ = dot(behind_mm, axis) > drawn_out_mm ? drawn_for_ + 1 : 0;
}

bool DrawnOut::draws_out() const { return drawn_for_ >= drawn_frames; }

int DrawnOut::tries() const { return std::min(4 + drawn_for_ / 4, 16); }

// The golden angle spreads the directions evenly.
DrawnOut::Place DrawnOut::next(const Mat3& frame, double step_mm) {
  const int n = ++tried_;
  const double turn = 2.399963 * n, size = 1.0 / (1 << n % 4), tilt_rad = size * tilt_rad_at_most * (n % 5) / 4,
               shift_mm = size * step_mm * (n % 3) / 2, out_mm = step_mm * (n % 7) / 6,
               pivot_mm = length_mm_ * (n % 11) / 20;
  const auto across = [&](double a) { return frame.column[0] * std::cos(a) + frame.column[1] * std::sin(a); };
  const Vec3 axis = frame.column[2];
  Place to;
  to.frame = turned(frame, axis + across(1.618034 * turn) * tilt_rad);
  to.way_mm = (axis - to.frame.column[2]) * pivot_mm + across(turn) * shift_mm + axis * out_mm;
  return to;
}

}  // namespace trephine::haptics
