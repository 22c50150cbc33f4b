// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "peers/contact_algorithm.h"

namespace trephine::peers {

/// When a ball that moves by `way` first touches a triangle, as a share of the way; 2: never. It touches the facet from
/// its front alone, and sides and corners from wherever. A ball that touches already is held only where it would go
/// deeper.
double touch_time(Vec3 centre, Vec3 way, double radius_mm, Vec3 a, Vec3 b, Vec3 c, Vec3 normal);

/// The proxy of finite radius [Ruspini1997]: a ball moves towards the device until it touches, then along the tangent
/// planes of what it touches, as long as it comes nearer. What it may touch is the local set, which is not of the paper
/// but of H3D, whose implementation the dissertation measured: with each picture the triangles within `local_set_mm` of
/// the way that the ball would go in the next `look_ahead_ratio` pictures if it went on as since the last one (H3D's
/// HapticsOptions, by default 15 mm and 3). The servo loop looks through them one by one. So the time of a tick grows
/// with how fine the mesh is, and a device that speeds up within a picture passes what it does not know.
class RoundProxy : public ContactAlgorithm {
 public:
  RoundProxy(const PeerScene& scene, const PeerParams& params) : scene_(scene), params_(params) {}
  const haptics::HapticState& update(const haptics::HapticInput& given) override;
  void client(Vec3 device_mm) override;
  void reset() override { begun_ = seen_ = false; }
  std::size_t local_triangles() const { return local_.size(); }

 private:
  struct Facet {
    Vec3 a, b, c, normal;
  };
  double first_touch(Vec3 way) const;
  int touched_planes(Vec3 device, contact::Plane* planes) const;

  const PeerScene scene_;
  const PeerParams params_;
  haptics::HapticState state_;
  bool begun_ = false, seen_ = false;
  Vec3 centre_, seen_at_;  // about the mesh's origin; the latter: when the last picture was made
  std::vector<Facet> local_;
};

}  // namespace trephine::peers
