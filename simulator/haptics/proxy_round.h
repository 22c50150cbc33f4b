// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "haptics/drawn_out.h"
#include "haptics/proxy_body.h"
#include "haptics/round_body.h"

namespace trephine::haptics {

/// The proxy of a round tool: the middle lines of its parts are held off surfaces by their radii (RoundBody). Planes
/// hold back the centre, which is the foremost end of the first middle line. A wall that holds back another place of a
/// line holds the centre back as a plane that is moved by the way from that place to the centre.
class ProxyRound : public ProxyBody {
 public:
  ProxyRound(ProxyGround& ground, const Tool& tool)
      : ProxyBody(ground),
        body_(ground.contact.contact(), tool.round),
        near_(ground.contact.meshes() ? tool.round.size() : 0),
        drawn_(tool.length_mm) {}
  bool begin(const HapticInput& in) override;
  void follow(const HapticInput& in) override;
  Vec3 axis_of(const HapticInput& in) const override { return in.axis == Vec3{} ? state_.axis : normalized(in.axis); }
  Vec3 held_mm() const override { return centre_mm_; }
  Vec3 wanted_mm(const HapticInput& in) const override { return in.tip_mm + state_.axis * body_.centre_mm(); }
  std::optional<Vec3> kept_from_turning(const HapticInput& in) const override;

 private:
  RoundBody::Touch deepest(Vec3 centre_mm, Vec3 axis, int inside, const contact::TouchableFaces& faces);
  void press_along(RoundBody::Touch& touch);
  bool is_free(Vec3 centre_mm, Vec3 axis);
  bool is_busy(double share) const;
  void turn(Vec3 axis);
  RoundBody::Touch move(Vec3 goal_mm);
  RoundBody::Touch close_to(Vec3 next_mm, RoundBody::Touch touch);
  HeldSurface held_of(const RoundBody::Touch& touch) const;
  bool meet(const RoundBody::Touch& touch, Vec3 device_mm, Vec3& goal_mm);
  void slide_out(Vec3 device_mm);
  contact::TouchableFaces closed_faces() const { return open_.closed(ground_.faces); }

  RoundBody body_;
  std::vector<touch::NearFacets> near_;  ///< of the parts
  Vec3 centre_mm_;
  OpenFaces open_;
  DrawnOut drawn_;
};

}  // namespace trephine::haptics
