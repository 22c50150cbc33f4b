// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "peers/contact_algorithm.h"

namespace trephine::peers {

/// Our own proxy on the haptic volume, under the conditions of the others: one shape, of which the front face is felt,
/// without friction, damping, limits and the smoothing of forces.
class VolumeProxy : public ContactAlgorithm {
 public:
  VolumeProxy(const PeerScene& scene, const PeerParams& params);
  const haptics::HapticState& update(const haptics::HapticInput& given) override { return proxy_.update(given); }
  void reset() override { proxy_.reset(); }

 private:
  haptics::Proxy proxy_;
};

/// The same with the dissertation's walk (stepped, a step of the smallest voxel side, nearest voxel), which looks at
/// the same voxels through a ContactVolume of its own.
class SteppedProxy : public ContactAlgorithm {
 public:
  SteppedProxy(const PeerScene& scene, const PeerParams& params);
  const haptics::HapticState& update(const haptics::HapticInput& given) override { return proxy_.update(given); }
  void reset() override { proxy_.reset(); }

 private:
  voxel::HapticVolume volume_;
  contact::ContactVolume contact_;
  haptics::Proxy proxy_;
};

}  // namespace trephine::peers
