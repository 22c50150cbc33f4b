// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/proxy_point.h"

namespace trephine::haptics {
namespace {

constexpr int max_passes = 6;

}  // namespace

ProxyPoint::ProxyPoint(ProxyGround& ground)
    : ProxyBody(ground), stepped_(ground.contact.params().walk == contact::ContactParams::Walk::stepped) {}

// Where the device is; or, where that is in a shape that nothing enters, on the nearest surface.
bool ProxyPoint::begin(const HapticInput& in) {
  Vec3 from = in.tip_mm;
  if (contact_.inside_mesh(from, ground_.faces)) {
    const auto m = contact_.meshes()->nearest(from, from, touch::WayOut::farthest_mm, ground_.faces.front);
    if (m.shape != 0) {  // else it is deeper than that in the mesh, and begins where it is
      state_.proxy_mm = from = m.point_mm - m.normal * ground_.margin_mm;
      state_.inside = contact_.shape_at(from);
    }
  }
  const int inside = state_.inside;
  if (!ground_.is_solid(inside)) return true;
  double nearest = touch::WayOut::farthest_mm;
  const contact::TouchableFaces ways_out{0, shape_bit(inside)};
  for (int n = 0; n < touch::WayOut::ways; ++n) {
    const Vec3 way = touch::WayOut::way(n);
    const contact::Contact c = contact_.cross(from, from + way * nearest, inside, ways_out);
    if (!c.hit) continue;
    const Vec3 outside = c.point_mm + way * ground_.margin_mm;
    if (contact_.shape_at(outside) == inside || contact_.inside_mesh(outside, ground_.faces)) continue;
    nearest *= c.along;
    state_.proxy_mm = outside;
    state_.inside = contact_.shape_at(outside);
  }
  return true;
}

void ProxyPoint::follow(const HapticInput& in) {
  const Vec3 before_mm = state_.proxy_mm;
  const int inside_before = state_.inside;
  state_.axis = in.axis;
  walk(in.tip_mm);
  // A stepped walk may end in a corner of bone between two samples, and a proxy that stopped there would be caught.
  if (stepped_ && contact_.shape_at(state_.proxy_mm) != state_.inside) {
    state_.proxy_mm = before_mm;
    state_.inside = inside_before;
  }
}

// Moves the proxy to just before the contact, a margin off its surface. A proxy that is already there stays, or it
// would creep along although friction holds it.
void ProxyPoint::approach(const contact::Contact& c) {
  const Vec3 way = c.point_mm - state_.proxy_mm;
  const double length = norm(way);
  state_.inside = c.from;
  if (length <= 4 * ground_.margin_mm) return;
  const Vec3 before = state_.proxy_mm + way * (1 - ground_.margin_mm / length);
  const contact::Contact off = contact_.cross(before, c.point_mm + c.normal * ground_.margin_mm, c.from, ground_.faces);
  state_.proxy_mm = off.hit ? before : off.point_mm;
  if (!off.hit) state_.inside = off.into;
}

void ProxyPoint::walk(Vec3 device) {
  surfaces_.clear();
  Vec3 goal = device;
  for (int pass = 0; pass < max_passes; ++pass) {
    const contact::Contact c = contact_.intersect(state_.proxy_mm, goal, state_.inside, ground_.faces);
    if (!c.hit) {
      state_.proxy_mm = goal;
      state_.inside = c.into;
      break;
    }
    if (!meet(c, device, goal, pass)) break;
  }
  if (surfaces_.count() == 0) ground_.friction.rest();
}

// Takes a contact in: pops through it, or adds its plane and sets the next goal. False where the proxy stays for this
// frame.
bool ProxyPoint::meet(const contact::Contact& c, Vec3 device, Vec3& goal, int pass) {
  const Vec3 before = state_.proxy_mm;
  approach(c);
  const int at = surfaces_.place_of(c.normal, c.shape);
  if (at == HeldSurfaces::max_count) return false;
  const bool known = at < surfaces_.count();
  // A surface is rougher than its smooth normal says, and may bar the way along its own tangent plane. The proxy then
  // climbs over the roughness; where it cannot, it takes the exact normal.
  const bool barred = known && pass > 0;
  if (barred && step_over(c, device, goal)) return false;
  Vec3 normal = c.normal;
  if (barred) {
    const Vec3 exact = contact_.exact_normal(c, goal - before);
    if (exact == Vec3{}) return false;
    if (dot(exact, goal - before) < 0) normal = exact;
  }
  surfaces_.set(at, {c.point_mm + normal * ground_.margin_mm, normal}, ground_.held(c));
  if (!surfaces_.solve(device)) return false;

  if (ground_.pops(at)) {
    const Vec3 in = c.point_mm - c.normal * ground_.margin_mm;
    const int inside = contact_.shape_at(in);
    if (inside != c.from) {
      state_.proxy_mm = in;
      state_.inside = inside;
      state_.events |= haptic_event::popped;
      surfaces_.clear();
      goal = device;
      return true;
    }
  }
  return ground_.friction.slide(surfaces_, at, state_.proxy_mm, device, goal);
}

// Goes up by a step, along, and down towards the device; false where that is barred as well.
bool ProxyPoint::step_over(const contact::Contact& c, Vec3 device, Vec3 goal) {
  const Vec3 up = c.normal * ground_.step_mm;
  const Vec3 top = state_.proxy_mm + up;
  const contact::Contact rise = contact_.cross(state_.proxy_mm, top, state_.inside, ground_.faces);
  if (rise.hit) return false;
  const contact::Contact across = contact_.cross(top, goal + up, rise.into, ground_.faces);
  if (across.hit && across.along < 0.5) return false;
  const double share = across.hit ? std::max(0.0, across.along - 0.01) : 1;
  state_.proxy_mm = top + (goal + up - top) * share;
  state_.inside = across.hit ? across.from : across.into;
  // Friction that turns a tool aside is not to be lost on the way down: there the tool goes straight down first.
  const bool straight = ground_.held(c).grain.any();
  const Vec3 below = straight ? straight_under(state_.proxy_mm, c.normal, device) : device;
  contact::Contact down = contact_.intersect(state_.proxy_mm, below, state_.inside, ground_.faces);
  if (straight && !down.hit) {
    state_.proxy_mm = below;
    state_.inside = down.into;
    down = contact_.intersect(below, device, state_.inside, ground_.faces);
  }
  if (down.hit) {
    approach(down);
  } else {
    state_.proxy_mm = device;
    state_.inside = down.into;
    surfaces_.clear();
  }
  return true;
}

}  // namespace trephine::haptics
