// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/proxy_shell.h"

#include <cmath>

namespace trephine::haptics {
namespace {

constexpr int max_passes = 10, turning_passes = 3;
constexpr double cancels = 0.2;  // two normals whose sum is shorter than this share of their lengths cancel
constexpr int slices = 16, out_tries = 4;
constexpr std::uint64_t max_looks = 4000;  // points that are tried in a frame, on the way out of bone

}  // namespace

ProxyShell::ProxyShell(ProxyGround& ground, const Tool& tool)
    : ProxyBody(ground),
      search_(tool.search),
      length_mm_(tool.length_mm),
      body_(ground.contact, tool.points_mm),
      lock_(tool),
      drawn_(tool.length_mm) {}

// The search for a place that is free may take some frames: it goes on in the next one at the distance that it had
// reached.
bool ProxyShell::begin(const HapticInput& in) {
  open_ = {};
  crossed_ = {0, 0};
  slice_ = 0;
  std::uint64_t solid = 0;
  for (std::size_t n = 1; n < ground_.feels.size(); ++n)
    if (ground_.is_solid(int(n))) solid |= shape_bit(int(n));
  const Mat3 frame = in.axis == Vec3{} ? frame_along({0, 0, 1}) : frame_of(in.axis, in.across);
  const std::uint64_t until = body_.looked_at() + max_looks;
  const auto place = [&](Vec3 tip) {
    bool free = body_.place(tip, frame, solid);
    for (int n = 0; contact_.meshes() && free && n < body_.count(); ++n)
      free = !contact_.inside_mesh(body_.at_mm(n), ground_.faces);
    return free;
  };
  bool free = place(in.tip_mm);
  while (!free && !ground_.way_out.exhausted() && body_.looked_at() < until) {
    const Vec3 way = ground_.way_out.next_mm(frame.column[2]);
    if (way != Vec3{}) free = place(in.tip_mm + way);
  }
  const bool begun = free || ground_.way_out.exhausted();
  if (!free) body_.place(in.tip_mm,
                         frame);  // where there is no way out, the points inside stay inside
  show();
  return begun;
}

void ProxyShell::show() {
  state_.proxy_mm = body_.tip_mm();
  state_.axis = body_.frame().column[2];
  state_.inside = body_.shape(0);
}

std::optional<Vec3> ProxyShell::kept_from_turning(const HapticInput& in) const {
  if (in.axis == Vec3{}) return {};
  const Mat3 aim = in.across == Vec3{} ? turned(body_.frame(), in.axis) : frame_of(in.axis, in.across);
  return rotation_between(aim, body_.frame());
}

void ProxyShell::follow(const HapticInput& in) {
  body_.begin_frame();
  surfaces_.clear();
  lock_.begin_frame();
  const Vec3 axis = in.axis == Vec3{} ? body_.frame().column[2] : in.axis;
  open_behind();
  unlock(normalized(axis));
  move_to(in, axis);
  if (drawn_.draws_out()) slide_out(in.tip_mm);
  show();
  drawn_.note(in.tip_mm - body_.tip_mm(), state_.axis);
  if (surfaces_.count() == 0) ground_.friction.rest();
}

void ProxyShell::move_to(const HapticInput& in, Vec3 axis) {
  ToolBody& b = body_;
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
    if (!meet(m, in.tip_mm, goal, aim, pass)) break;
  }
}

contact::Plane ProxyShell::tip_plane(int point, Vec3 normal) const {
  return {body_.met(point).point_mm + normal * ground_.margin_mm - body_.arm(point), normal};
}

// The wall that the tool meets, or two walls where their normals would cancel each other in the average. The nearest
// point that collides says where the wall is; the points that the searches from both ends find give its normal.
int ProxyShell::find_walls(const ToolBody::Meeting& m, Wall* walls) const {
  const ToolBody& b = body_;
  const auto normal_of = [&](int point) { return contact_.normal_of(b.met(point), b.way(point)); };
  const auto no_further = [&](contact::Plane plane) {
    const contact::Plane near = tip_plane(m.nearest, plane.normal);
    return dot(plane.normal, near.point_mm - plane.point_mm) > 0 ? near : plane;
  };
  if (search_ != ToolParams::Search::both || m.from_tip == m.from_tail) {
    const int point = search_ == ToolParams::Search::tail_to_tip ? m.from_tail : m.from_tip;
    walls[0] = {no_further(tip_plane(point, normal_of(point))), point};
    return 1;
  }
  const bool tip_first = b.met(m.from_tip).along <= b.met(m.from_tail).along;
  const int near = tip_first ? m.from_tip : m.from_tail, far = tip_first ? m.from_tail : m.from_tip;
  const Vec3 a = normal_of(near), c = normal_of(far), sum = a + c;
  const bool facets = touch::is_mesh(b.met(near).shape) || touch::is_mesh(b.met(far).shape);
  if (norm(sum) < cancels * (norm(a) + norm(c)) || (facets && dot(a, c) < HeldSurfaces::same_facet)) {
    walls[0] = {tip_plane(near, a), near};
    walls[1] = {tip_plane(far, c), far};
    return 2;
  }
  walls[0] = {no_further(tip_plane(near, normalized(sum))), near};
  return 1;
}

void ProxyShell::approach(const ToolBody::Meeting& m) {
  const double length = norm(body_.way(m.nearest)), reach = m.along * length;
  if (reach > 4 * ground_.margin_mm) body_.advance((reach - ground_.margin_mm) / length, closed_faces());
}

void ProxyShell::hold_turn(Vec3 device, Vec3& goal, Mat3& aim) {
  aim = body_.frame();
  goal = device;
  surfaces_.clear();
}

// Takes a wall or two in: pops through it, or adds planes and sets the next goal. False where the tool stays where it
// is for this frame.
bool ProxyShell::meet(const ToolBody::Meeting& m, Vec3 device, Vec3& goal, Mat3& aim, int pass) {
  ToolBody& b = body_;
  const bool turning = !(aim == b.frame());
  const Vec3 turn = aim.column[2] - b.frame().column[2];
  Wall walls[2];
  const int walls_met = find_walls(m, walls);
  bool barred = pass > 0 && walls_met == 1 && surfaces_.knows(walls[0].plane.normal, b.met(walls[0].point).shape);
  if (barred && walls[0].point != m.nearest) {
    walls[0] = {tip_plane(m.nearest, contact_.normal_of(b.met(m.nearest), b.way(m.nearest))), m.nearest};
    barred = surfaces_.knows(walls[0].plane.normal, b.met(walls[0].point).shape);
  }
  const bool lock = lock_.begin(ground_, b, m, turn, !drawn_.draws_out());
  const Vec3 way = b.way(walls[0].point), arm = b.arm(walls[0].point),
             arms[2] = {arm, b.arm(walls[walls_met - 1].point)};
  const contact::Contact contacts[2] = {b.met(walls[0].point), b.met(walls[walls_met - 1].point)};
  approach(m);
  if (lock) {
    hold_turn(device, goal, aim);
    return true;
  }
  if (barred) {
    if (!turning && step_over(walls[0].plane.normal, ground_.held(contacts[0]).grain.any(), device, goal)) return false;
    const Vec3 exact = contact_.exact_normal(contacts[0], way);
    if (exact != Vec3{} && dot(exact, way) < 0)
      walls[0].plane = {contacts[0].point_mm + exact * ground_.margin_mm - arm, exact};
  }
  int put[2] = {-1, -1};
  for (int n = 0; n < walls_met; ++n)
    if ((put[n] = surfaces_.put(walls[n].plane, ground_.held(contacts[n]))) >= 0) surfaces_.move_arm(put[n], arms[n]);
  if (put[0] < 0) surfaces_.leave_unsolved();
  if (put[0] < 0 || !surfaces_.solve(device) || (turning && pass + 1 == turning_passes)) {
    if (!turning) return false;
    hold_turn(device, goal, aim);
    return true;
  }
  for (int n = 0; n < walls_met; ++n) {
    if (put[n] < 0 || !ground_.pops(put[n])) continue;
    pop_into(contacts[n]);
    goal = device;
    return true;
  }
  // Friction acts along the walls. For a turn, the tip may first have to give way.
  contact::Nearest here;
  Vec3 from = b.tip_mm();
  const bool gives = surfaces_.nearest_to(from, here) && norm(here.point_mm - from) > 2 * ground_.margin_mm;
  if (gives) from = here.point_mm;
  if (ground_.friction.slide(surfaces_, put[0], from, device, goal)) return true;
  goal = from;
  return gives || turning;
}

// Opens the faces that a point has popped through to all points.
void ProxyShell::pop_into(const contact::Contact& c) {
  open_.open.front |= shape_bit(c.into);
  open_.open.back |= shape_bit(c.from);
  crossed_.front |= shape_bit(c.into);
  crossed_.back |= shape_bit(c.from);
  slice_ = 0;
  state_.events |= haptic_event::popped;
  surfaces_.clear();
}

// Goes up by a step, along, and down towards the device, as ProxyPoint::step_over() does.
bool ProxyShell::step_over(Vec3 normal, bool straight, Vec3 device, Vec3 goal) {
  ToolBody& b = body_;
  const Mat3 frame = b.frame();
  const contact::TouchableFaces faces = closed_faces();
  const Vec3 up = normal * ground_.step_mm, before = b.tip_mm();
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
    approach(down);
  } else {
    b.arrive();
    if (!barred) {
      surfaces_.clear();
    }
  }
  return !barred;
}

// Looks at one slice of the axis in each frame. Shapes that were popped through and are found in no slice close again.
void ProxyShell::open_behind() {
  const std::uint64_t open = open_.shapes();
  if (open == 0) return;
  const ToolBody& b = body_;
  std::uint64_t found = 0;
  const Vec3 axis = b.frame().column[2];
  Vec3 at = b.tip_mm() + axis * (length_mm_ * slice_ / slices);
  const Vec3 end = b.tip_mm() + axis * (length_mm_ * (slice_ + 1) / slices);
  int shape = contact_.shape_at(at);
  found |= shape_bit(shape);
  for (int n = 0; n < 8; ++n) {
    const contact::Contact c = contact_.cross(at, end, shape, {open, open});
    if (!c.hit) break;
    found |= shape_bit(c.from) | shape_bit(c.into);
    at = c.point_mm;
    shape = c.into;
  }
  for (int i = 0; i < b.count(); ++i) found |= shape_bit(b.shape(i));
  crossed_.front |= found & open_.open.front;
  crossed_.back |= found & open_.open.back;
  if (++slice_ < slices) return;
  slice_ = 0;
  open_.open = crossed_;
  crossed_ = {0, 0};
}

void ProxyShell::unlock(Vec3 axis) {
  lock_.end(state_, axis, drawn_.draws_out(), [&] {
    ToolBody& b = body_;
    return b.sweep(b.tip_mm(), turned(b.frame(), axis, max_turn_rad), closed_faces()).hit;
  });
}

// Moves the tool along its own axis as far as the device is drawn, without friction: a straight shaft is always free to
// leave that way. Where it touches the rim, it gives way a little to the side.
void ProxyShell::slide_out(Vec3 device) {
  ToolBody& b = body_;
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
    approach(m);
    if (b.sweep(b.tip_mm() + normal * ground_.step_mm, b.frame(), closed_faces()).hit) {
      work_loose();
      return;
    }
    b.arrive();
  }
}

// A tool may be jammed aslant, with points on both sides of a rim. It is shaken loose as a hand would do it: each try
// is walked as any other way is, so no point crosses a face.
void ProxyShell::work_loose() {
  ToolBody& b = body_;
  for (int n = 0; n < drawn_.tries(); ++n) {
    const DrawnOut::Place to = drawn_.next(b.frame(), ground_.step_mm);
    if (b.sweep(b.tip_mm() + to.way_mm, to.frame, closed_faces()).hit) continue;
    b.arrive();
    return;
  }
}

}  // namespace trephine::haptics
