// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/vec3.h"
#include "voxel/haptic_volume.h"

namespace trephine {

/// Occupancy of one shape, 0 to 1, of a haptic volume: what contact, drilling and the mesher read. Nothing here
/// allocates, locks or throws; positions that are not finite give 0. The decoder refers to the volume, which must
/// outlive it; voxels may change meanwhile (drilling), the lattice and the shapes may not.
class HapticDecoder {
 public:
  explicit HapticDecoder(const HapticVolume& volume);

  /// Number of the shape that fills most of the voxel; 0 for EMPTY, for values of no shape and beyond the lattice.
  int shape_at(int i, int j, int k) const;
  /// Occupancy of shape `number` in the voxel, its share of another shape's voxel included (haptic_volume.h).
  double occupancy(int number, int i, int j, int k) const;

  double nearest(int number, Vec3 world_mm) const;    ///< of the voxel that holds the point
  double trilinear(int number, Vec3 world_mm) const;  ///< between the eight voxel centres around it
  /// Gradient of the trilinear occupancy by central differences over one voxel a side, 1/mm, world: it points into the
  /// shape. Zero where there is none.
  Vec3 gradient(int number, Vec3 world_mm) const;

 private:
  const HapticVolume& volume_;
};

}  // namespace trephine
