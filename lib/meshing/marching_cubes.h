// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "surface/trimesh.h"

namespace trephine {

/// Where the samples above the isovalue lie.
struct InsideVoxels {
  std::size_t count = 0;
  Box box;
};

/// Throws Error 65 naming the first voxel that is not finite.
template <class T>
InsideVoxels find_inside(const Grid<T>& grid, double isovalue);

/// Marching cubes over the voxels of `inside` and one layer around them, in continuous indices of the grid (points_mm
/// holds them, with origin 0). That frame is right-handed, and the triangles face outwards in it. Samples above the
/// isovalue are inside. A point lies between the two samples of its lattice edge, at least `margin` (of the edge) from
/// either, and halfway where one of the two lies outside the grid. The result has the same bytes whatever the thread
/// count.
template <class T>
TriMesh marching_cubes(const Grid<T>& grid, double isovalue, const InsideVoxels& inside, double margin,
                       const Progress& progress);

extern template InsideVoxels find_inside(const Grid<std::int16_t>&, double);
extern template InsideVoxels find_inside(const Grid<float>&, double);
extern template TriMesh marching_cubes(const Grid<std::int16_t>&, double, const InsideVoxels&, double, const Progress&);
extern template TriMesh marching_cubes(const Grid<float>&, double, const InsideVoxels&, double, const Progress&);

}  // namespace trephine
