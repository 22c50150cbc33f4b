// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "peers/contact_algorithm.h"
#include "peers/depth_picture.h"

namespace trephine::peers {

/// Haptics of a depth buffer, as in OpenHaptics (its programmer's guide, shapes of the depth buffer with the haptic
/// camera): with each picture a camera that looks along the contact's normal, and without contact from the device onto
/// the nearest surface, draws the depth around the tool; the servo loop feels that picture as a landscape. What is
/// hidden from the camera, such as a wall along its view, is not there, and nothing is felt beside the picture.
class DepthBuffer : public ContactAlgorithm {
 public:
  DepthBuffer(const PeerScene& scene, const PeerParams& params)
      : scene_(scene), params_(params), picture_(params.depth_pixels, params.depth_side_mm) {}
  const haptics::HapticState& update(const haptics::HapticInput& given) override;
  void client(Vec3 device_mm) override;
  void reset() override;

 private:
  double first_below(Vec3 from, Vec3 to) const;

  const PeerScene scene_;
  const PeerParams params_;
  haptics::HapticState state_;
  DepthPicture picture_;
  bool begun_ = false, fresh_ = false;
  Vec3 proxy_, normal_;  // about the mesh's origin; normal: zero without contact
};

}  // namespace trephine::peers
