// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "surface/trimesh.h"

namespace trephine {

/// The voxels of the mask that hold exactly `label` (as 1); label 0 stands for every value but 0.
Mask select_label(const Mask& labels, int label);

/// Volume of the voxels that are not 0.
double volume_mm3(const Mask& mask);

/// Dice's coefficient 2 |a and b| / (|a| + |b|) of what is not 0 (Dice 1945): 1 the same, 0 apart; 1 where both are
/// empty. The masks lie on one raster, each on any part of it; what one does not cover is outside of it. Throws 65
/// where the rasters differ.
double dice(const Mask& a, const Mask& b);

/// 1 where a voxel's centre lies inside the mesh, by parity: what lies in an even number of nested or overlapping
/// shells is outside. Every row of the lattice is crossed by an even number of triangles whatever the rounding, for
/// each edge decides once for both its triangles on which side of the row it passes; so no voxel leaks. A centre
/// exactly on the surface belongs to one side or the other, the same each time; two closed meshes that share a face
/// share none of its voxels. Parts of the mesh beyond the lattice are cut off.
///
/// Throws 65 as check_mesh does, and where rows leave the mesh more often than they enter it: it is not closed.
Mask voxelize_inside(const TriMesh& mesh, const Lattice& lattice, const Progress& progress = {});

}  // namespace trephine
