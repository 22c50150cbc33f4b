// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <memory>

#include "peers/contact_algorithm.h"
#include "peers/experiment.h"
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

struct PokeParams {
  double max_tilt_rad = M_PI / 3;  ///< from the plate's normal
  double farthest_mm = 60;         ///< from the plate along the poke, where the device rests before
  int ticks_a_picture = peers::ticks_a_picture;
};

/// Pokes `pokes` times straight through, `mm_a_tick` a tick, until the device is 6 mm behind the plate (3 N at 0.5
/// N/mm, which devices can give); returns how often the proxy was beyond the plate at the end. Before, the device
/// rests, 2 mm to `farthest_mm` away, until a picture was made; then it goes at once at its speed, at any time between
/// two pictures.
int count_falls(ContactAlgorithm& algorithm, const Slab& slab, double mm_a_tick, int pokes,
                const PokeParams& params = {});

}  // namespace trephine::peers
