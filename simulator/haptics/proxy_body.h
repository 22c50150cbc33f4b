// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>

#include "contact/contact.h"
#include "haptics/feel.h"
#include "haptics/haptic_state.h"
#include "haptics/held_surfaces.h"
#include "haptics/sliding_friction.h"
#include "haptics/tool.h"
#include "haptics/tool_body.h"
#include "touch/felt_space.h"
#include "touch/way_out.h"

namespace trephine::haptics {

/// What the proxy of every tool stands on: what there is to feel with its faces, and in each frame the surfaces that
/// hold it, their friction, and the state that is shown.
struct ProxyGround {
  ProxyGround(const touch::FeltSpace& space, const Feels& all);
  HeldSurface held(const contact::Contact& contact) const;
  /// Whether the surface at that place of `surfaces` is pressed harder than it bears.
  bool pops(int place) const;
  /// Whether nothing enters the shape, so that no tool may begin in it.
  bool is_solid(int shape) const;

  const touch::FeltSpace contact;
  Feels feels;
  contact::TouchableFaces faces;
  double margin_mm, step_mm;     ///< off a surface; over its roughness
  std::uint64_t giving_way = 0;  ///< HapticInput
  double held_ratio = 1;
  HapticState state;
  HeldSurfaces surfaces;
  SlidingFriction friction;
  tissue::Relaxations relaxing;
  touch::WayOut way_out;
};

/// How the proxy of one kind of tool begins and follows the device: it moves ProxyGround::state, and leaves in
/// ProxyGround::surfaces what holds it. It allocates in its constructor alone.
class ProxyBody {
 public:
  virtual ~ProxyBody() = default;
  /// Puts the tool where the device is, or next to the shape that it would start in; false where the search for such a
  /// place goes on in the next frame.
  virtual bool begin(const HapticInput& in) = 0;
  /// Moves the tool towards the device as far as surfaces let it.
  virtual void follow(const HapticInput& in) = 0;
  /// The axis that it takes the device to have.
  virtual Vec3 axis_of(const HapticInput& in) const { return in.axis; }
  /// What the surfaces hold back, and where the device would have it; the tip, unless a tool says otherwise.
  virtual Vec3 held_mm() const { return state_.proxy_mm; }
  virtual Vec3 wanted_mm(const HapticInput& in) const { return in.tip_mm; }
  /// How the tool is shown turned about its axis.
  virtual Vec3 across(const HapticInput& in) const { return in.across; }
  /// The rotation from the device's orientation to the shown one, in rad; none where surfaces never keep it from
  /// turning.
  virtual std::optional<Vec3> kept_from_turning(const HapticInput&) const { return {}; }
  virtual const ToolBody* points() const { return nullptr; }

 protected:
  explicit ProxyBody(ProxyGround& ground)
      : ground_(ground), contact_(ground.contact), state_(ground.state), surfaces_(ground.surfaces) {}
  ProxyGround& ground_;
  const touch::FeltSpace& contact_;
  HapticState& state_;
  HeldSurfaces& surfaces_;
};
/// `ground` must outlive it.
std::unique_ptr<ProxyBody> proxy_body(ProxyGround& ground, const Tool& tool);

/// The faces that a tool has popped through: they are open to all of it until it has left their shapes.
struct OpenFaces {
  contact::TouchableFaces open{0, 0};
  contact::TouchableFaces closed(const contact::TouchableFaces& faces) const {
    return {faces.front & ~open.front, faces.back & ~open.back};
  }
  std::uint64_t shapes() const { return open.front | open.back; }
};
inline std::uint64_t shape_bit(int shape) { return shape != 0 ? std::uint64_t{1} << shape : 0; }

/// The place straight under `from` that lies as deep as the device.
inline Vec3 straight_under(Vec3 from_mm, Vec3 normal, Vec3 device_mm) {
  return from_mm - normal * std::max(0.0, dot(normal, from_mm - device_mm));
}

}  // namespace trephine::haptics
