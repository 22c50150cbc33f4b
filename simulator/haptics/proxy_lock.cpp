// SPDX-License-Identifier: GPL-3.0-or-later
// The lock of a tool of many points, and how a tool that is drawn out of a hole comes free.
#include <algorithm>
#include <cmath>

#include "haptics/proxy.h"

namespace trephine::haptics {
namespace {

constexpr int unlock_frames = 8;
constexpr double drawn_out_mm = 0.3, loose_tilt_rad = 0.02;
constexpr double line_holds_mm = 6;      // across the tool
constexpr double touching_ratio = 0.02;  // of a voxel's side: as deep as discs let a round tool be
constexpr int drawn_frames = 5, out_tries = 4;

// In a tick: more where it took long already.
int loose_tries(int drawn_frames_so_far) { return std::min(4 + drawn_frames_so_far / 4, 16); }

}  // namespace

// The orientation lock of [Rizzi, chapter 5, Table V]: the first points that collide from either end are further apart
// than lock_distance_mm, while the tool is turned into the wall of one of them. The normal of that wall is kept, not
// always that of the point h in the table: between opposite walls the tool may turn away from the wall of h.
bool Proxy::should_lock(const ToolBody::Meeting& m, Vec3 turn) {
  const ToolBody& b = *body_;
  const auto collided = [&](int point) {
    return Collided{point, b.met(point).point_mm, contact_.normal_of(b.met(point), b.way(point)), held(b.met(point))};
  };
  if (tool_.search != ToolParams::Search::both || !(tool_.lock_distance_mm > 0) || state_.locked) {
    any_collided_ = true;
    return false;
  }
  if (!any_collided_ || m.from_tip < from_tip_.point) from_tip_ = collided(m.from_tip);
  if (!any_collided_ || m.from_tail > from_tail_.point) from_tail_ = collided(m.from_tail);
  any_collided_ = true;
  if (draws_out()) return false;
  if (norm(turn) < 1e-9 || !(norm(from_tip_.at_mm - from_tail_.at_mm) > tool_.lock_distance_mm)) return false;
  const Collided* into = dot(from_tip_.normal, turn) < 0    ? &from_tip_
                         : dot(from_tail_.normal, turn) < 0 ? &from_tail_
                                                            : nullptr;
  if (!into) return false;
  state_.locked = true;
  state_.events |= haptic_event::locked;
  lock_normal_ = into->normal;
  lock_dot_ = dot(lock_normal_, b.frame().column[2]);
  locked_for_ = 0;
  line_held_ = into->held;
  return true;
}

// Counts the frames in which the device is so far behind the tool, on its tail's side.
void Proxy::note_drawn(Vec3 behind_mm) { drawn_for_ = dot(behind_mm, state_.axis) > drawn_out_mm ? drawn_for_ + 1 : 0; }

// Whether the device has drawn the tool outwards for some frames, and it did not come: then no lock may hold it in its
// hole.
bool Proxy::draws_out() const { return drawn_for_ >= drawn_frames; }

// Moves the tool along its own axis as far as the device is drawn, without friction: a straight shaft is always free to
// leave that way. Where it touches the rim, it gives way a little to the side.
void Proxy::slide_out(Vec3 device) {
  ToolBody& b = *body_;
  const Vec3 axis = b.frame().column[2];
  for (int n = 0; n < out_tries; ++n) {
    const double left = dot(device - b.tip_mm(), axis);
    if (!(left > 0)) return;
    const ToolBody::Meeting m = b.sweep(b.tip_mm() + axis * left, b.frame(), closed_faces());
    if (!m.hit) {
      b.arrive();
      return;
    }
    const Vec3 normal = contact_.normal_of(b.met(m.nearest), b.way(m.nearest));
    approach_tool(m);
    if (b.sweep(b.tip_mm() + normal * step_mm_, b.frame(), closed_faces()).hit) {
      work_loose();
      return;
    }
    b.arrive();
  }
}

// A place close by, a little further out: the tool is shifted across its axis and tilted about a place of its shaft,
// each time another way. The golden angle spreads the directions evenly.
Proxy::Loose Proxy::next_loose(const Mat3& frame) {
  const int n = ++loosened_;
  const double turn = 2.399963 * n, size = 1.0 / (1 << n % 4), tilt_rad = size * loose_tilt_rad * (n % 5) / 4,
               shift_mm = size * step_mm_ * (n % 3) / 2, out_mm = step_mm_ * (n % 7) / 6,
               pivot_mm = tool_.length_mm * (n % 11) / 20;
  const auto across = [&](double a) { return frame.column[0] * std::cos(a) + frame.column[1] * std::sin(a); };
  const Vec3 axis = frame.column[2];
  Loose to;
  to.frame = turned(frame, axis + across(1.618034 * turn) * tilt_rad);
  to.way_mm = (axis - to.frame.column[2]) * pivot_mm + across(turn) * shift_mm + axis * out_mm;
  return to;
}

// A tool may be jammed aslant, with points on both sides of a rim. It is shaken loose as a hand would do it: each try
// is walked as any other way is, so no point crosses a face.
void Proxy::work_loose() {
  ToolBody& b = *body_;
  for (int n = 0; n < loose_tries(drawn_for_); ++n) {
    const Loose to = next_loose(b.frame());
    if (b.sweep(b.tip_mm() + to.way_mm, to.frame, closed_faces()).hit) continue;
    b.arrive();
    return;
  }
}

// As slide_out() and work_loose(), for a round tool. Its steps are shorter than its radius. Where it is a little in a
// wall already, it takes of the places that were tried the one where it is the least deep.
void Proxy::slide_out_round(Vec3 device) {
  struct Place {
    Vec3 centre, axis;
    int inside;
    double depth_mm;
  };
  const auto deep = [](const RoundBody::Touch& t) { return t.hit ? t.depth_mm : 0; };
  const auto look = [&](Vec3 centre, Vec3 axis) {
    const contact::Contact through = contact_.cross(centre_mm_, centre, state_.inside, closed_faces());
    const double depth_mm = through.hit ? HUGE_VAL : deep(round_->deepest(centre, axis, through.into, closed_faces()));
    return Place{centre, axis, through.into, depth_mm};
  };
  const auto go_to = [&](const Place& place) {
    centre_mm_ = place.centre;
    state_.axis = place.axis;
    state_.inside = place.inside;
  };
  for (int n = 0; n < out_tries; ++n) {
    const double left = dot(device - centre_mm_, state_.axis);
    if (!(left > 0)) return;
    const Vec3 begin = centre_mm_;
    const RoundBody::Touch touch = move_round(begin + state_.axis * left);
    if (!touch.hit && !(centre_mm_ == begin)) return;
    if (!touch.hit) break;
    const Place aside = look(centre_mm_ + touch.contact.normal * step_mm_, state_.axis);
    if (aside.depth_mm > 0) break;
    go_to(aside);
  }
  Place best = look(centre_mm_, state_.axis);
  const double touches_mm = touching_ratio * contact_.smallest_side_mm();  // counts as free
  for (int n = 0; n < loose_tries(drawn_for_); ++n) {
    const Loose to = next_loose(frame_along(state_.axis));
    const Vec3 axis = to.frame.column[2];
    const Vec3 turned_mm = (axis - state_.axis) * round_->centre_mm();  // of the centre, about the tip
    const Place place = look(centre_mm_ + to.way_mm + turned_mm, axis);
    if (place.depth_mm > std::max(touches_mm, best.depth_mm)) continue;
    best = place;
    if (place.depth_mm <= touches_mm) break;
  }
  go_to(best);
}

// A hand that is pulled far aside is not held on the line: then the lock holds the turn alone.
bool Proxy::holds_line(Vec3 device) const {
  return state_.locked && tool_.lock == ToolParams::Lock::line &&
         norm(cross(device - body_->tip_mm(), body_->frame().column[2])) <= line_holds_mm;
}

// A tool whose lock is a line: it keeps its orientation, and its tip moves along its own axis alone, without friction;
// the spring to the device holds the hand on that line.
void Proxy::follow_line(Vec3 device) {
  ToolBody& b = *body_;
  const Vec3 axis = b.frame().column[2];
  const double left = dot(device - b.tip_mm(), axis);
  const ToolBody::Meeting m = b.sweep(b.tip_mm() + axis * left, b.frame(), closed_faces());
  if (m.hit) {
    const contact::Contact met = b.met(m.nearest);
    const cases::CaseFace& feel = held(met).feel;
    approach_tool(m);
    const double pressed = std::abs(dot(device - b.tip_mm(), axis));
    if (feel.pop_through_n > 0 && feel.stiffness_n_per_mm * pressed > feel.pop_through_n) pop_into(met);
  } else {
    b.arrive();
  }
  if (draws_out()) slide_out(device);
  state_.proxy_mm = b.tip_mm();
  state_.axis = b.frame().column[2];
  state_.inside = b.shape(0);
  note_drawn(device - b.tip_mm());
  const Vec3 back = b.tip_mm() - device;
  if (!(norm(back) > 4 * margin_mm_)) return;
  surfaces_.set(0, {b.tip_mm(), normalized(back)}, line_held_);
}

// Ends the lock as in [Rizzi, chapter 5, Table VI]. From time to time it also looks whether the turn, or of a line
// the way to the hand, is free, and ends the lock where it is, because the tool was drawn out.
void Proxy::try_unlock(Vec3 axis, Vec3 device) {
  if (!state_.locked) return;
  ToolBody& b = *body_;
  const auto barred = [&] {
    if (!b.sweep(b.tip_mm(), turned(b.frame(), axis, max_turn_rad), closed_faces()).hit) return false;
    return tool_.lock == ToolParams::Lock::turn || b.sweep(device, b.frame(), closed_faces()).hit;
  };
  if (!(dot(lock_normal_, axis) > lock_dot_ + 1e-12) && !draws_out() &&
      (++locked_for_ % unlock_frames != 0 || barred()))
    return;
  state_.locked = false;
  state_.events |= haptic_event::unlocked;
}

}  // namespace trephine::haptics
