// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "peers/contact_algorithm.h"

namespace trephine::peers {

/// An intermediate representation: with each picture the plane that touches the surface where it is nearest to the
/// proxy; the servo loop feels that plane alone, at its own rate [Adachi1995]. A new plane would make the force jump,
/// so it begins where it gives the force of the plane before, and reaches its own place after the recovery time
/// [Mark1996].
class TangentPlane : public ContactAlgorithm {
 public:
  TangentPlane(const PeerScene& scene, const PeerParams& params) : scene_(scene), params_(params) {}
  const haptics::HapticState& update(const haptics::HapticInput& given) override;
  void client(Vec3 device_mm) override;
  void reset() override;

 private:
  double depth(Vec3 device) const;

  const PeerScene scene_;
  const PeerParams params_;
  haptics::HapticState state_;
  bool begun_ = false, has_plane_ = false;
  contact::Plane plane_;                  // about the mesh's origin
  double recovers_mm_ = 0, since_s_ = 0;  // by how much its depth was wrong at first, and for how long it is there
  Vec3 proxy_;
};

}  // namespace trephine::peers
