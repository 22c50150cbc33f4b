// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "haptics/device_port.h"
#include "haptics_scene.h"

namespace trephine::haptic_scenes {

inline haptics::ForceParams device_limits() {
  haptics::ForceParams p;
  p.ramp_s = 0.05;
  return p;
}
// A floor below z = 0, and a servo over it that is run by the test.
struct Floor {
  voxel::HapticVolume volume = empty(60, {2, 2, 2});
  haptics::Feels feels = one_shape(1, face(0.5), face(0.5));
  std::unique_ptr<contact::ContactVolume> contact;
  explicit Floor(double stiffness = 0.5, double friction = 0)
      : feels(one_shape(1, face(stiffness, friction, friction), face(stiffness))) {
    fill(volume, 1, [](Vec3 p) { return -p.z; });
    contact = std::make_unique<contact::ContactVolume>(volume);
  }
};

}  // namespace trephine::haptic_scenes
