// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "peers/contact_algorithm.h"
#include "voxel/haptic_volume.h"

namespace trephine::peers {

/// A plate to poke through, turned against all axes, as triangles and as voxels.
struct Slab {
  double thickness_mm = 0, voxel_mm = 0;
  Vec3 middle_mm, normal, along, across;  ///< unit
  std::unique_ptr<FeltMesh> mesh;
  voxel::HapticVolume volume;
  std::unique_ptr<contact::ContactVolume> contact;
  static constexpr double side_mm = 40;
  PeerScene scene() const { return {mesh.get(), contact.get(), 1}; }
};

/// A plate of that thickness; its occupancy is what a voxel holds of it. The triangles have sides of 2 mm.
std::unique_ptr<Slab> make_slab(double thickness_mm, double voxel_mm);
/// A wall of one voxel, each of them full, where no way from face to face avoids it; without triangles.
std::unique_ptr<Slab> make_voxel_wall(double voxel_mm);

/// Pokes `pokes` times straight through, `mm_a_tick` a tick, at up to 60 degrees from the normal; returns how often the
/// proxy was beyond the plate at the end. Pictures are made 59 times a second of the servo's time; before a poke the
/// device rests until there was one.
int count_falls(ContactAlgorithm& algorithm, const Slab& slab, double mm_a_tick, int pokes);

}  // namespace trephine::peers
