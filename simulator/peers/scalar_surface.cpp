// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers/scalar_surface.h"

#include <algorithm>

namespace trephine::peers {

const haptics::HapticState& ScalarSurface::update(const haptics::HapticInput& given) {
  const Vec3 device = given.tip_mm;
  if (!begun_) {
    proxy_ = device;
    begun_ = true;
  }
  const Vec3 out = -normalized(decoder_.gradient(scene_.shape, proxy_));
  bool held = false;
  if (out == Vec3{}) {
    proxy_ = device;
  } else {
    const double strength = params_.most_strength_n * decoder_.trilinear(scene_.shape, proxy_);
    const Vec3 way = device - proxy_;
    const double presses = -dot(way, out);
    const double holds = std::min(std::max(presses, 0.0), strength / params_.spring_n_per_mm);
    proxy_ = device + out * holds;
    held = holds > 0;
  }
  answer(state_, given, proxy_, held, out, scene_.shape, params_.spring_n_per_mm);
  return state_;
}

}  // namespace trephine::peers
