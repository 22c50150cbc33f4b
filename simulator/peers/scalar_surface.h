// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "peers/contact_algorithm.h"
#include "voxel/decode.h"

namespace trephine::peers {

/// The scalar-surface mode of volume haptics by primitives (VHTK) [Lundin2002]: there is no surface. Wherever the proxy
/// is, the gradient of the scalar gives a plane primitive that resists what presses against it, up to a strength which
/// a transfer function gives for the scalar. Along the plane, and out of the shape, the proxy follows the device; where
/// it is pressed harder than the strength it gives way. The scalar is the shape's occupancy, and the strength rises
/// from 0 in an empty voxel to `most_strength_n` in a full one. Where the scalar is even, inside of bone, there is
/// nothing to feel.
class ScalarSurface : public ContactAlgorithm {
 public:
  ScalarSurface(const PeerScene& scene, const PeerParams& params)
      : scene_(scene), params_(params), decoder_(scene.contact->volume()) {}
  const haptics::HapticState& update(const haptics::HapticInput& given) override;
  void reset() override { begun_ = false; }

 private:
  const PeerScene scene_;
  const PeerParams params_;
  const voxel::HapticDecoder decoder_;
  haptics::HapticState state_;
  bool begun_ = false;
  Vec3 proxy_;
};

}  // namespace trephine::peers
