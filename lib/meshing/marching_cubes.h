// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

/// Where the samples above the isovalue lie.
struct InsideVoxels {
  std::size_t count = 0;
  grid::Box box;
};

/// Throws Error 65 naming the first voxel that is not finite.
template <class T>
InsideVoxels find_inside(const grid::Grid<T>& grid, double isovalue);

/// Marching cubes over the voxels of `inside` and one layer around them, in continuous indices of the grid (points_mm
/// holds them, with origin 0). That frame is right-handed, and the triangles face outwards in it. Samples above the
/// isovalue are inside. A point lies between the two samples of its lattice edge, at least `margin` (of the edge) from
/// either, and halfway where one of the two lies outside the grid. The result has the same bytes whatever the thread
/// count.
template <class T>
surface::TriMesh marching_cubes(const grid::Grid<T>& grid, double isovalue, const InsideVoxels& inside, double margin,
                                const Progress& progress);

extern template InsideVoxels find_inside(const grid::Grid<std::int16_t>&, double);
extern template InsideVoxels find_inside(const grid::Grid<float>&, double);
extern template surface::TriMesh marching_cubes(const grid::Grid<std::int16_t>&, double, const InsideVoxels&, double,
                                                const Progress&);
extern template surface::TriMesh marching_cubes(const grid::Grid<float>&, double, const InsideVoxels&, double,
                                                const Progress&);

}  // namespace trephine::meshing
