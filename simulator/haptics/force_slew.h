// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/vec3.h"
#include "haptics/feel.h"

namespace trephine::haptics {

/// Keeps the force of a running drill continuous: it changes by at most max_n_per_ms, whatever the voxels do, but in an
/// event that has a name, a membrane that pops or bone that is breached. Then it goes from what is felt to what is to
/// be felt within event_s, along event_shape. Where the hand itself moves, the force follows as fast as its own spring
/// does: a force that lagged behind would push a tool that is taken back, and throw off one that lands. When the drill
/// stops it goes on until it has caught up.
class ForceSlew {
 public:
  static constexpr double max_n_per_ms = 0.095;  // what else changes it, such as rounding, is within 0.1
  explicit ForceSlew(const ForceParams& params) : event_s_(params.event_s), shape_(params.event_shape) {}
  /// `explained_n`: by how much the hand's own motion may have changed it.
  Vec3 follow(Vec3 force_n, bool drilling, bool event, double explained_n, double dt_s);
  void reset();

 private:
  double share(double of_time) const;
  double event_s_;
  ForceParams::Shape shape_;
  Vec3 felt_, from_;
  double age_s_ = -1;  // of an event; below 0: there is none
  bool behind_ = false, begun_ = false;
};

}  // namespace trephine::haptics
