// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/ventriculostomy/script_places.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace trephine::lessons {
namespace {

constexpr double beyond_mm = 400;  // from the head's middle: where a ray to the skin begins
constexpr double step_rad = M_PI / 360;

Vec3 turned_towards(Vec3 from, Vec3 across, double angle) { return from * std::cos(angle) + across * std::sin(angle); }

}  // namespace

ScriptPlaces::ScriptPlaces(const ScriptScene& scene, const HeadFrame& frame, const ScriptAim& aim)
    : scene_(scene), frame_(frame), missed_(aim) {}

Vec3 ScriptPlaces::direction_of(Vec3 p) const { return normalized(p - frame_.centre_mm); }

Vec3 ScriptPlaces::skin_towards(Vec3 direction) const {
  const Vec3 c = frame_.centre_mm;
  const contact::Contact hit = scene_.contact.intersect(c + direction * beyond_mm, c);
  if (!hit.hit) throw Error(ExitCode::bad_input, "", "", "no skin is felt there");
  return hit.point_mm;
}

std::vector<Vec3> ScriptPlaces::directions_between(Vec3 from, Vec3 to) const {
  const double angle = std::acos(std::clamp(dot(from, to), -1.0, 1.0));
  const Vec3 across = normalized(to - from * dot(to, from));
  const int n = std::max(1, int(std::ceil(angle / (2 * step_rad))));
  std::vector<Vec3> all;
  for (int i = 0; i <= n; ++i) all.push_back(normalized(turned_towards(from, across, angle * i / n)));
  return all;
}

// From the point on the skin, in the plane through the head's middle that holds `towards`.
Vec3 ScriptPlaces::over_skin(Vec3 from, Vec3 towards, double by_mm) const {
  const Vec3 start = direction_of(from);
  const Vec3 across = normalized(towards - start * dot(towards, start)) * (by_mm < 0 ? -1.0 : 1.0);
  Vec3 at = from;
  double left = std::abs(by_mm);
  for (int n = 1; left > 0 && n * step_rad < M_PI; ++n) {
    const Vec3 next = skin_towards(turned_towards(start, across, n * step_rad));
    const double step = norm(next - at);
    if (step >= left) return at + (next - at) * (left / step);
    left -= step;
    at = next;
  }
  return at;
}

Vec3 ScriptPlaces::named(const std::string& name) const {
  if (name == "mark") {
    if (mark_mm) return *mark_mm;
    throw Error(ExitCode::bad_input, "", "at", "mark: nothing was drawn before");
  }
  if (name == "hole") {
    if (hole_mm) return *hole_mm;
    if (mark_mm) return *mark_mm;  // whoever tries the catheter without a hole tries it there
    throw Error(ExitCode::bad_input, "", "at", "hole: nothing was drilled or marked before");
  }
  std::string known;
  if (const std::optional<Vec3> place = find_case_place(scene_.manifest, name, known)) return *place;
  throw Error(ExitCode::bad_input, "", "at", name + ": the case has no such place, but mark, hole, " + known);
}

Vec3 ScriptPlaces::find(const ScriptPlace& place) {
  const HeadFrame& f = frame_;
  Vec3 p = named(place.at);
  if (place.along_mm != 0) {
    // Backwards along the midline: from the nasion over the top.
    p -= f.left * f.left_of_midline_mm(p);
    const Vec3 out = direction_of(p);
    p = over_skin(skin_towards(out), cross(out, f.left), place.along_mm);
  }
  if (place.right_mm != 0) p = over_skin(skin_towards(direction_of(p)), -f.left, place.right_mm);
  return missed_(p + Vec3{place.offset_mm[0], place.offset_mm[1], place.offset_mm[2]});
}

}  // namespace trephine::lessons
