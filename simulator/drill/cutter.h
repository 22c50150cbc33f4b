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
  bool round_end = false;  ///< of a cylinder with a = b: its end at the tip is a half ball
};

/// How much more than itself a cutter takes: on all sides, and about up to three places that hold its tool.
struct Wider {
  double mm = 0, held_mm = 0;  ///< on all sides; at such a place, two voxels from which it is mm again
  int places = 0;
  Vec3 at_mm[3];
  Wider(double on_all_sides_mm = 0) : mm(on_all_sides_mm) {}
  double most_mm() const { return places > 0 && held_mm > mm ? held_mm : mm; }
};

/// The pose of a tool: its foremost point, and a frame whose third column points from the tip to the tail.
struct ToolPose {
  Vec3 tip_mm;
  Mat3 frame;
};

}  // namespace trephine::drill
