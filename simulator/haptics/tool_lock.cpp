// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/tool_lock.h"

namespace trephine::haptics {
// The normal of the wall into which the tool is turned is kept, not always that of the point h in Table V: between
// opposite walls the tool may turn away from the wall of h.
bool ToolLock::begin(ProxyGround& ground, const ToolBody& b, const ToolBody::Meeting& m, Vec3 turn, bool may_begin) {
  const auto collided = [&](int point) {
    return Collided{point, b.met(point).point_mm, ground.contact.normal_of(b.met(point), b.way(point))};
  };
  if (!may_ || ground.state.locked) {
    any_collided_ = true;
    return false;
  }
  if (!any_collided_ || m.from_tip < from_tip_.point) from_tip_ = collided(m.from_tip);
  if (!any_collided_ || m.from_tail > from_tail_.point) from_tail_ = collided(m.from_tail);
  any_collided_ = true;
  if (!may_begin) return false;
  if (norm(turn) < 1e-9 || !(norm(from_tip_.at_mm - from_tail_.at_mm) > distance_mm_)) return false;
  const Collided* into = dot(from_tip_.normal, turn) < 0    ? &from_tip_
                         : dot(from_tail_.normal, turn) < 0 ? &from_tail_
                                                            : nullptr;
  if (!into) return false;
  ground.state.locked = true;
  ground.state.events |= haptic_event::locked;
  normal_ = into->normal;
  dot_ = dot(normal_, b.frame().column[2]);
  locked_for_ = 0;
  return true;
}

}  // namespace trephine::haptics
