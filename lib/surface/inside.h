// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "surface/trimesh.h"

namespace trephine::surface {

/// A mask that is 1 where a voxel's centre lies inside the mesh, by parity: a point in an even number of nested or
/// overlapping shells is outside. Every row of the lattice is crossed by an even number of triangles whatever the
/// rounding, because each edge decides once for both its triangles on which side of the row it passes; so no voxel
/// leaks. A centre exactly on the surface always belongs to the same side, and two closed meshes that share a face
/// share none of its voxels. Parts of the mesh beyond the lattice are cut off.
///
/// Throws Error 65 as check_mesh does, and where rows leave the mesh more often than they enter it, because then the
/// mesh is not closed.
grid::Mask voxelize_inside(const TriMesh& mesh, const grid::Lattice& lattice, const Progress& progress = {});

}  // namespace trephine::surface
