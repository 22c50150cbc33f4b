// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers/volume_proxy.h"

namespace trephine::peers {
namespace {

haptics::Feels only(int shape, double spring_n_per_mm) {
  haptics::Feels feels;
  for (haptics::ShapeFeel& f : feels) f.front.touchable = f.back.touchable = false;
  cases::CaseFace& front = feels[std::size_t(shape)].front;
  front = cases::CaseFace{};
  front.touchable = true;
  front.stiffness_n_per_mm = spring_n_per_mm;
  front.damping_n_s_per_mm = front.static_friction_ratio = front.dynamic_friction_ratio = 0;
  front.pop_through_n = 0;
  return feels;
}

haptics::ForceParams without_limits() {
  haptics::ForceParams p;
  p.max_force_n = 100;
  p.max_force_rate_n_per_s = 1e6;
  p.ramp_s = p.release_s = 0;
  return p;
}

contact::ContactParams as_in_chapter_3() {
  contact::ContactParams p;
  p.walk = contact::ContactParams::Walk::stepped;
  p.surface = contact::ContactParams::Surface::nearest;
  p.step_ratio = 1;
  return p;
}

}  // namespace

VolumeProxy::VolumeProxy(const PeerScene& scene, const PeerParams& params)
    : proxy_(*scene.contact, only(scene.shape, params.spring_n_per_mm), without_limits()) {}

SteppedProxy::SteppedProxy(const PeerScene& scene, const PeerParams& params)
    : volume_(voxel::copy_without_hardness(scene.contact->volume())),
      contact_(volume_, as_in_chapter_3()),
      proxy_(contact_, only(scene.shape, params.spring_n_per_mm), without_limits()) {}

}  // namespace trephine::peers
