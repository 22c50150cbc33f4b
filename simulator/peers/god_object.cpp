// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers/god_object.h"

#include <algorithm>

#include "contact/constraints.h"

namespace trephine::peers {

const haptics::HapticState& GodObject::update(const haptics::HapticInput& given) {
  const FeltMesh& mesh = *scene_.mesh;
  const Vec3 device = given.tip_mm - mesh.mesh().origin_mm;
  if (!begun_) {
    god_ = device;
    rests_ = 0;
    begun_ = true;
  }
  contact::Plane planes[3];
  std::uint32_t on[3];
  int count = 0;
  Vec3 goal = device;
  while (count < 3) {
    FeltMesh::Crossing met;
    for (int n = 0; n < rests_ && !met.hit(); ++n) {
      const std::uint32_t t = rests_on_[n];
      if (std::find(on, on + count, t) == on + count && mesh.above(t, goal) < 0 && mesh.is_over(t, god_)) met = {t, 0};
    }
    if (!met.hit()) met = mesh.first_crossing(god_, goal, on, count);
    if (!met.hit()) break;
    const Vec3 normal = mesh.normal(met.triangle);
    on[count] = met.triangle;
    planes[count++] = {mesh.corner(met.triangle, 0) + normal * params_.god_object_lift_mm, normal};
    contact::Nearest nearest;
    if (!contact::nearest_before(planes, count, device, nearest)) {
      goal = god_ + (goal - god_) * met.along;  // the facets leave no other place
      break;
    }
    goal = nearest.point_mm;
  }
  // Three constraints determine the place, and whatever else is in the way stops it.
  if (count == 3)
    if (const FeltMesh::Crossing met = mesh.first_crossing(god_, goal, on, count); met.hit())
      goal = god_ + (goal - god_) * met.along;
  god_ = goal;
  rests_ = count;
  std::copy(on, on + count, rests_on_);
  answer(state_, given, god_ + mesh.mesh().origin_mm, count > 0, count > 0 ? planes[count - 1].normal : Vec3{},
         scene_.shape, params_.spring_n_per_mm);
  return state_;
}

}  // namespace trephine::peers
