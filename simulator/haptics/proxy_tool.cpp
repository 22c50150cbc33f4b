// SPDX-License-Identifier: GPL-3.0-or-later
// The proxy of a tool of many points. All planes hold back the tip: where a wall holds back a point that lies `arm`
// away from the tip, the tip may not go behind that wall moved by -arm.
#include <algorithm>
#include <cmath>

#include "haptics/proxy.h"

namespace trephine::haptics {
namespace {

constexpr int max_passes = 10, turning_passes = 3;
constexpr double cancels = 0.2;  // two normals whose sum is shorter than this share of their lengths cancel
constexpr int slices = 16;
constexpr std::uint64_t max_looks = 4000;  // points that are tried in a frame, on the way out of bone

std::uint64_t bit(int shape) { return shape != 0 ? std::uint64_t{1} << shape : 0; }

}  // namespace

// Puts the tool where the device is; or, where a point of it would lie in a shape that nothing enters, next to that
// shape. That may take some frames: the search goes on in the next frame at the distance that it had reached.
void Proxy::begin_tool(const HapticInput& in) {
  open_ = crossed_ = {0, 0};
  slice_ = 0;
  std::uint64_t solid = 0;
  for (std::size_t n = 1; n < feels_.size(); ++n)
    if (feels_[n].front.touchable && !(feels_[n].front.pop_through_n > 0)) solid |= bit(int(n));
  const Mat3 frame = in.axis == Vec3{} ? frame_along({0, 0, 1}) : frame_of(in.axis, in.across);
  const std::uint64_t until = body_->looked_at() + max_looks;
  bool free = body_->place(in.tip_mm, frame, solid);
  while (!free && !way_out_.exhausted() && body_->looked_at() < until) {
    const Vec3 way = way_out_.next_mm(frame.column[2]);
    if (way != Vec3{}) free = body_->place(in.tip_mm + way, frame, solid);
  }
  begun_ = free || way_out_.exhausted();
  if (!free) body_->place(in.tip_mm, frame);  // where there is no way out, the points inside stay inside
  state_.proxy_mm = moved_from_mm_ = body_->tip_mm();
  state_.axis = frame.column[2];
  state_.inside = body_->shape(0);
}

contact::TouchableFaces Proxy::closed_faces() const { return {faces_.front & ~open_.front, faces_.back & ~open_.back}; }

void Proxy::follow_tool(const HapticInput& in) {
  ToolBody& b = *body_;
  b.begin_frame();
  surfaces_.clear();
  any_collided_ = false;
  const Vec3 axis = in.axis == Vec3{} ? b.frame().column[2] : in.axis;
  open_behind();
  try_unlock(normalized(axis), in.tip_mm);
  if (holds_line(in.tip_mm)) return follow_line(in.tip_mm);
  Mat3 aim = state_.locked         ? b.frame()
             : in.across == Vec3{} ? turned(b.frame(), axis, max_turn_rad)
                                   : turned_to(b.frame(), frame_of(axis, in.across), max_turn_rad);
  Vec3 goal = in.tip_mm;
  for (int pass = 0; pass < max_passes; ++pass) {
    const ToolBody::Meeting m = b.sweep(goal, aim, closed_faces());
    if (!m.hit) {
      b.arrive();
      break;
    }
    if (!meet_tool(m, in.tip_mm, goal, aim, pass)) break;
  }
  if (draws_out()) slide_out(in.tip_mm);
  state_.proxy_mm = b.tip_mm();
  state_.axis = b.frame().column[2];
  state_.inside = b.shape(0);
  note_drawn(in.tip_mm - b.tip_mm());
  if (surfaces_.count() == 0) friction_.rest();
}

contact::Plane Proxy::tip_plane(int point, Vec3 normal) const {
  return {body_->met(point).point_mm + normal * margin_mm_ - body_->arm(point), normal};
}

// The wall that the tool meets, or two walls where their normals would cancel each other in the average. The nearest
// point that collides says where the wall is; the points that the searches from both ends find give its normal.
int Proxy::find_walls(const ToolBody::Meeting& m, Wall* walls) const {
  const ToolBody& b = *body_;
  const auto normal_of = [&](int point) { return contact_.normal_of(b.met(point), b.way(point)); };
  const auto no_further = [&](contact::Plane plane) {
    const contact::Plane near = tip_plane(m.nearest, plane.normal);
    return dot(plane.normal, near.point_mm - plane.point_mm) > 0 ? near : plane;
  };
  if (tool_.search != ToolParams::Search::both || m.from_tip == m.from_tail) {
    const int point = tool_.search == ToolParams::Search::tail_to_tip ? m.from_tail : m.from_tip;
    walls[0] = {no_further(tip_plane(point, normal_of(point))), point};
    return 1;
  }
  const bool tip_first = b.met(m.from_tip).along <= b.met(m.from_tail).along;
  const int near = tip_first ? m.from_tip : m.from_tail, far = tip_first ? m.from_tail : m.from_tip;
  const Vec3 a = normal_of(near), c = normal_of(far), sum = a + c;
  if (norm(sum) < cancels * (norm(a) + norm(c))) {
    walls[0] = {tip_plane(near, a), near};
    walls[1] = {tip_plane(far, c), far};
    return 2;
  }
  walls[0] = {no_further(tip_plane(near, normalized(sum))), near};
  return 1;
}

void Proxy::approach_tool(const ToolBody::Meeting& m) {
  const double length = norm(body_->way(m.nearest)), reach = m.along * length;
  if (reach > 4 * margin_mm_) body_->advance((reach - margin_mm_) / length, closed_faces());
}

void Proxy::hold_turn(Vec3 device, Vec3& goal, Mat3& aim) {
  aim = body_->frame();
  goal = device;
  surfaces_.clear();
}

// As meet(), for a tool of many points. False where the tool stays where it is for this frame.
bool Proxy::meet_tool(const ToolBody::Meeting& m, Vec3 device, Vec3& goal, Mat3& aim, int pass) {
  ToolBody& b = *body_;
  const bool turning = !(aim == b.frame());
  const Vec3 turn = aim.column[2] - b.frame().column[2];
  Wall walls[2];
  const int walls_met = find_walls(m, walls);
  bool barred = pass > 0 && walls_met == 1 && surfaces_.knows(walls[0].plane.normal);
  if (barred && walls[0].point != m.nearest) {
    walls[0] = {tip_plane(m.nearest, contact_.normal_of(b.met(m.nearest), b.way(m.nearest))), m.nearest};
    barred = surfaces_.knows(walls[0].plane.normal);
  }
  const bool lock = should_lock(m, turn);
  const Vec3 way = b.way(walls[0].point), arm = b.arm(walls[0].point),
             arms[2] = {arm, b.arm(walls[walls_met - 1].point)};
  const contact::Contact contacts[2] = {b.met(walls[0].point), b.met(walls[walls_met - 1].point)};
  approach_tool(m);
  if (lock) {
    hold_turn(device, goal, aim);
    return true;
  }
  if (barred) {
    if (!turning && step_over_tool(walls[0].plane.normal, held(contacts[0]).grain.any(), device, goal)) return false;
    const Vec3 exact = contact_.exact_normal(contacts[0], way);
    if (exact != Vec3{} && dot(exact, way) < 0)
      walls[0].plane = {contacts[0].point_mm + exact * margin_mm_ - arm, exact};
  }
  int put[2] = {-1, -1};
  for (int n = 0; n < walls_met; ++n)
    if ((put[n] = surfaces_.put(walls[n].plane, held(contacts[n]))) >= 0) surfaces_.move_arm(put[n], arms[n]);
  if (put[0] < 0) surfaces_.leave_unsolved();
  if (put[0] < 0 || !surfaces_.solve(device) || (turning && pass + 1 == turning_passes)) {
    if (!turning) return false;
    hold_turn(device, goal, aim);
    return true;
  }
  for (int n = 0; n < walls_met; ++n) {
    if (put[n] < 0) continue;
    const cases::CaseFace& feel = surfaces_.surface(put[n]).feel;
    if (!(feel.pop_through_n > 0) || feel.stiffness_n_per_mm * surfaces_.pressure_mm(put[n]) <= feel.pop_through_n)
      continue;
    pop_into(contacts[n]);
    goal = device;
    return true;
  }
  // Friction acts along the walls. For a turn, the tip may first have to give way.
  contact::Nearest here;
  Vec3 from = b.tip_mm();
  const bool gives = surfaces_.nearest_to(from, here) && norm(here.point_mm - from) > 2 * margin_mm_;
  if (gives) from = here.point_mm;
  if (friction_.slide(surfaces_, put[0], from, device, goal)) return true;
  goal = from;
  return gives || turning;
}

// Opens the faces that a point has popped through to all points.
void Proxy::pop_into(const contact::Contact& c) {
  open_.front |= bit(c.into);
  open_.back |= bit(c.from);
  crossed_.front |= bit(c.into);
  crossed_.back |= bit(c.from);
  slice_ = 0;
  state_.events |= haptic_event::popped;
  surfaces_.clear();
}

// Goes up by a step, along, and down towards the device, as step_over() does.
bool Proxy::step_over_tool(Vec3 normal, bool straight, Vec3 device, Vec3 goal) {
  ToolBody& b = *body_;
  const Mat3 frame = b.frame();
  const contact::TouchableFaces faces = closed_faces();
  const Vec3 up = normal * step_mm_, before = b.tip_mm();
  if (b.sweep(before + up, frame, faces).hit) return false;
  b.arrive();
  const ToolBody::Meeting across = b.sweep(goal + up, frame, faces);
  const bool barred = across.hit && across.along < 0.5;
  if (!across.hit)
    b.arrive();
  else if (!barred)
    b.advance(across.along - 0.01, faces);
  const Vec3 below = straight ? straight_under(b.tip_mm(), normal, device) : device;
  ToolBody::Meeting down = b.sweep(barred ? before : below, frame, faces);
  if (straight && !barred && !down.hit) {
    b.arrive();
    down = b.sweep(device, frame, faces);
  }
  if (down.hit) {
    approach_tool(down);
  } else {
    b.arrive();
    if (!barred) {
      surfaces_.clear();
    }
  }
  return !barred;
}

// Looks at one slice of the axis in each frame. Shapes that were popped through and are found in no slice close again.
void Proxy::open_behind() {
  if (open_.front == 0 && open_.back == 0) return;
  const ToolBody& b = *body_;
  const std::uint64_t open = open_.front | open_.back;
  std::uint64_t found = 0;
  const Vec3 axis = b.frame().column[2];
  Vec3 at = b.tip_mm() + axis * (tool_.length_mm * slice_ / slices);
  const Vec3 end = b.tip_mm() + axis * (tool_.length_mm * (slice_ + 1) / slices);
  int shape = contact_.shape_at(at);
  found |= bit(shape);
  for (int n = 0; n < 8; ++n) {
    const contact::Contact c = contact_.cross(at, end, shape, {open, open});
    if (!c.hit) break;
    found |= bit(c.from) | bit(c.into);
    at = c.point_mm;
    shape = c.into;
  }
  for (int i = 0; i < b.count(); ++i) found |= bit(b.shape(i));
  crossed_.front |= found & open_.front;
  crossed_.back |= found & open_.back;
  if (++slice_ < slices) return;
  slice_ = 0;
  open_ = crossed_;
  crossed_ = {0, 0};
}

}  // namespace trephine::haptics
