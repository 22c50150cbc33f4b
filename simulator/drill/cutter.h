// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/vec3.h"

namespace trephine::drill {

/// What a rotating tool cuts with [Rizzi, chapter 6]. A ball (a burr, Table VII) touches the tip with its foremost
/// point. A cylinder (a craniotome, Table VIII; a burr, where a = b) reaches from the tip `height_mm` along the axis,
/// and has the semi-axes a and b along the frame's first and second column.
struct Cutter {
  enum class Kind { ball, cylinder };
  Kind kind = Kind::ball;
  double radius_mm = 2.5;                                    ///< of a ball
  double semi_a_mm = 1.15, semi_b_mm = 1.15, height_mm = 8;  ///< of a cylinder
  bool round_end = false;  ///< of a cylinder with a = b: its end at the tip is a half ball (Drill::cut_way and cut_to)
};

/// The pose of a tool: its foremost point, and a frame whose third column points from the tip to the tail.
struct ToolPose {
  Vec3 tip_mm;
  Mat3 frame;
};

/// How a cutter's weight w (1 on its axis or in its centre, 0 on its surface: 1 - |x - c|^2 / R^2, or 1 - (x/a)^2 -
/// (y/b)^2) adds up at a point while the cutter goes straight, at a constant speed, from one pose to another with the
/// same frame. The integral is exact.
class CutterSweep {
 public:
  CutterSweep(const Cutter& cutter, const ToolPose& from, Vec3 to_tip_mm);

  /// The mean of the weight over the time, 0 to 1.
  double dose(Vec3 point_mm) const;
  /// A ball that holds every point with a dose.
  Vec3 middle_mm() const { return middle_; }
  double reach_mm() const { return reach_; }

 private:
  Vec3 begin_, way_;  // of what the weight is counted from, in mm
  Mat3 frame_;
  Vec3 per_mm_;  // scales to a unit ball or cylinder
  Vec3 step_;    // the way, scaled
  double step_squared_ = 0, height_ = 0;
  bool cylinder_ = false;
  Vec3 middle_;
  double reach_ = 0;
};

}  // namespace trephine::drill
