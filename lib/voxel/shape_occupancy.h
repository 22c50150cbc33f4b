// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Occupancy of single solids on a lattice; for the sources of this room.
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "grid/grid.h"
#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine::voxel::detail {

/// Half the width of the ramp of occupancy, in mm, where the surface has this normal (unit, world): the reach of a
/// voxel's 26 neighbours along the normal. With this width trilinear interpolation reproduces a plane of any direction
/// exactly (all eight voxels around a point of the surface lie on the ramp), and a voxel on the ramp has a neighbour on
/// the other side, to whose shape its rest may belong.
inline double ramp_mm(const grid::Lattice& lattice, Vec3 normal) {
  const Vec3 n = transpose_times(lattice.direction, normal);
  return std::abs(n.x) * lattice.spacing_mm.x + std::abs(n.y) * lattice.spacing_mm.y +
         std::abs(n.z) * lattice.spacing_mm.z;
}
/// No ramp is wider than this.
inline double largest_ramp_mm(const grid::Lattice& lattice) { return norm(lattice.spacing_mm); }

/// The share, of 255, at a signed distance (positive outside): 1/2 - d / (2 ramp).
inline int share_at(double distance_mm, double ramp) {
  const double o = 0.5 - distance_mm / (2 * ramp);
  return !(o > 0) ? 0 : o >= 1 ? 255 : int(std::floor(255 * o + 0.5));
}

/// The solid within a closed surface, 0 to 255 for each voxel. Throws Error 65 where it is not closed.
grid::Grid<std::uint8_t> solid_occupancy(const surface::TriMesh& mesh, const grid::Lattice& lattice,
                                         const Progress& progress);

/// The same of a field's solid, with VoxelizeShape::turned; its pieces and cavities all count. Its surface is taken to
/// be planes about the places where the field crosses 0 on the edges of its voxels (of parts of them, where they are
/// larger than the lattice's): what a flat surface has is exact, and what bends is off by what it bends from voxel to
/// voxel.
grid::Grid<std::uint8_t> solid_occupancy(const grid::Field& field, const std::vector<bool>& turned,
                                         const grid::Lattice& lattice, const Progress& progress);

/// Takes from a solid what lies deeper than `shell_mm` below its own surface. The inner face has a ramp as the outer
/// one; it follows the distance from every second voxel on, linearly between them.
void keep_shell(const surface::TriMesh& mesh, double shell_mm, grid::Grid<std::uint8_t>& solid,
                const Progress& progress);

/// The occupancy of what lies farther than `clear_mm` from the solid, for the voxels whose `wanted` is not 0; the
/// others may have any value. Its face is as exact as the inner one of a shell.
struct Clearance {
  grid::Grid<std::uint8_t> left;
  grid::Mask inside;  ///< the solid's voxels
};
Clearance clear_occupancy(const surface::TriMesh& mesh, double clear_mm, const grid::Grid<std::uint8_t>& wanted,
                          const Progress& progress);

}  // namespace trephine::voxel::detail
