// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the walks, the normals and the samples of a ContactVolume share.
#include "contact/clear_blocks.h"
#include "contact/contact.h"
#include "contact/known_blocks.h"
#include "contact/voxel_table.h"

namespace trephine::contact {

/// A haptic volume with what its raw values mean and what is known of its blocks. Positions are in voxel indices.
struct FeltLattice {
  FeltLattice(voxel::HapticVolume& volume_, const ContactParams& params_);
  Vec3 to_index(Vec3 world_mm) const { return index_of_world * (world_mm - volume.voxels.origin_mm); }
  /// Whether the boxes of the voxels are felt, and not the sub-voxel surface.
  bool boxes() const { return params.surface == ContactParams::Surface::nearest; }
  /// The shape that holds the point, 0 for none and beyond the lattice.
  int shape_of(Vec3 index) const;
  /// The shape that holds the voxel's box.
  int shape_of_voxel(int i, int j, int k) const;

  voxel::HapticVolume& volume;
  const ContactParams params;
  const VoxelTable table;
  KnownBlocks blocks;
  ClearBlocks clear;
  Mat3 index_of_world;  ///< of world minus origin
  double smallest_side_mm = 1;
};

}  // namespace trephine::contact
