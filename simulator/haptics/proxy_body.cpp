// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/proxy_body.h"

#include "haptics/proxy_point.h"
#include "haptics/proxy_round.h"
#include "haptics/proxy_shell.h"

namespace trephine::haptics {

namespace {

std::vector<tissue::SolidLaw> laws_of(const Feels& feels) {
  std::vector<tissue::SolidLaw> laws;
  for (const ShapeFeel& f : feels) laws.push_back({f.rest_ratio, f.relaxation_s});
  return laws;
}

}  // namespace

ProxyGround::ProxyGround(const touch::FeltSpace& space, const Feels& all)
    : contact(space), feels(all), faces(touchable_of(all)), relaxing(laws_of(all)) {
  const Vec3 s = space.volume().voxels.spacing_mm;
  const bool boxes = space.params().surface == contact::ContactParams::Surface::nearest;
  margin_mm = 1e-3 * space.smallest_side_mm();
  step_mm = boxes ? 1.05 * std::max({s.x, s.y, s.z}) : 0.1 * space.smallest_side_mm();
}

HeldSurface ProxyGround::held(const contact::Contact& c) const {
  const ShapeFeel& shape = feels[std::size_t(c.shape)];
  const bool front = c.face == contact::ContactFace::front;
  cases::CaseFace feel = front ? shape.front : shape.back;
  if (giving_way & shape_bit(c.shape)) {
    feel.stiffness_n_per_mm *= held_ratio;
    feel.damping_n_s_per_mm *= held_ratio;
  }
  feel.stiffness_n_per_mm *= contact.stiffness_ratio(c);
  return {c.shape, front ? 1 : 2, c.into, feel, Grain(shape, feel), {}, c.point_mm};
}

bool ProxyGround::pops(int place) const {
  const cases::CaseFace& feel = surfaces.surface(place).feel;
  const double whole = feel.stiffness_n_per_mm * surfaces.pressure_mm(place);
  return feel.pop_through_n > 0 && whole > feel.pop_through_n &&
         whole * relaxing.share(surfaces.surface(place).shape, whole) > feel.pop_through_n;
}

bool ProxyGround::is_solid(int shape) const {
  const cases::CaseFace& front = feels[std::size_t(shape)].front;
  return shape != 0 && front.touchable && !(front.pop_through_n > 0);
}

std::unique_ptr<ProxyBody> proxy_body(ProxyGround& ground, const Tool& tool) {
  if (!tool.points_mm.empty()) return std::make_unique<ProxyShell>(ground, tool);
  if (!tool.round.empty()) return std::make_unique<ProxyRound>(ground, tool);
  return std::make_unique<ProxyPoint>(ground);
}

}  // namespace trephine::haptics
