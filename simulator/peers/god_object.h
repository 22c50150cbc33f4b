// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "peers/contact_algorithm.h"

namespace trephine::peers {

/// The god-object on a triangle mesh [Zilles1995], with a search tree for its facets. In each tick the way from the
/// god-object to the device is looked through: a facet that it passes from front to back becomes a constraint, and the
/// god-object goes where the distance to the device is least on up to three of them. A facet on which it rests is kept
/// for as long as the device is behind it and the god-object within its sides, for its own place is then on the facet's
/// plane but for rounding.
///
/// Without any tolerance (bare) it falls through: where it slides from one facet to a neighbour, rounding decides
/// whether it is in front of that one. `god_object_lift_mm` mends it, by the distance that it is kept above its facets,
/// as HAPI does whose implementation the dissertation measured.
class GodObject : public ContactAlgorithm {
 public:
  GodObject(const PeerScene& scene, const PeerParams& params) : scene_(scene), params_(params) {}
  const haptics::HapticState& update(const haptics::HapticInput& given) override;
  void reset() override { begun_ = false; }
  /// Another mesh about the same origin from now on, from where it is; null until there is one, and no update() before.
  void feel(const FeltMesh* mesh) {
    scene_.mesh = mesh;
    rests_ = 0;
  }
  /// About the mesh's origin; nothing before it began.
  std::optional<Vec3> place_mm() const { return begun_ ? std::optional<Vec3>(god_) : std::nullopt; }
  void move_to(Vec3 place_mm) {
    god_ = place_mm;
    begun_ = true;
  }

 private:
  PeerScene scene_;
  const PeerParams params_;
  haptics::HapticState state_;
  bool begun_ = false;
  Vec3 god_;  // about the mesh's origin
  std::uint32_t rests_on_[3] = {};
  int rests_ = 0;
};

}  // namespace trephine::peers
