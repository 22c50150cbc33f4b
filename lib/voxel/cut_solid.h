// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a solid leaves of a lattice's voxels; for the sources of this room.
#include "grid/grid.h"
#include "surface/bounds.h"
#include "surface/distance_function.h"
#include "surface/trimesh.h"

namespace trephine::voxel::detail {

/// The voxels within `margin_voxels` of the solid's bounds, on the lattice.
grid::Box box_of(const grid::Lattice& lattice, const surface::Bounds& bounds_mm, Vec3 margin_voxels);

/// A solid seen from the lattice's voxels.
class SolidOnLattice {
 public:
  SolidOnLattice(const grid::Lattice& lattice, const surface::DistanceFunction& solid)
      : lattice_(lattice), solid_(solid) {}

  struct Sample {
    double distance_mm;  ///< positive outside; infinite where the function gives none
    double ramp_mm;      ///< width of the occupancy ramp here; 0 where the voxel lies beyond every ramp
    int left;            ///< 0 to 255: what the solid leaves of the voxel
  };
  Sample at(int i, int j, int k) const;

 private:
  const grid::Lattice& lattice_;
  const surface::DistanceFunction& solid_;
};

}  // namespace trephine::voxel::detail
