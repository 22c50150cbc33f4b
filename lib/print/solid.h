// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Solids as distances on a raster, of which walls, gaps and offsets are made.
#include <cmath>

#include "base/parallel.h"
#include "base/progress.h"
#include "grid/grid.h"
#include "grid/sample.h"
#include "mask/bits.h"
#include "surface/trimesh.h"

namespace trephine::print {

/// A solid: positive inside, 0 on its surface; about a distance in mm within a voxel of it. Beyond the lattice there is
/// nothing.
using Solid = grid::Field;

/// The lattice of voxels of `voxel_mm` that covers the box, its axes those of the frame; voxel centres lie at whole
/// multiples of the spacing, so that two such lattices share theirs.
grid::Lattice lattice_over(const surface::Bounds& box, double voxel_mm);

/// Sets every voxel to f(its centre, its value), in parallel.
template <class F>
void change(Solid& solid, const F& f) {
  parallel_for(0, solid.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < int(to); ++k)
      for (int j = 0; j < solid.size[1]; ++j)
        for (int i = 0; i < solid.size[0]; ++i) {
          float& v = solid.at(i, j, k);
          v = float(f(solid.to_world_mm({double(i), double(j), double(k)}), double(v)));
        }
  });
}

/// Nothing, in places that no part reaches.
constexpr double nowhere_mm = -1e3;
/// The solid at a place between its voxels.
inline double at(const Solid& solid, Vec3 mm) {
  return grid::sampled(solid, solid.to_index(mm), grid::value_beyond(nowhere_mm));
}
/// Its slope over `reach_mm` to each side, per mm; points into the solid.
Vec3 slope(const Solid& solid, Vec3 mm, double reach_mm);

bool is_empty(const Solid& solid);
mask::BitMask inside_of(const Solid& solid);
double volume_ml(const Solid& solid);

/// The solid as true distances (mask/filters.h); an empty one stays far from everything.
Solid as_distances(const Solid& solid, const Progress& progress = {});

/// What balls of that radius can fill of the solid: every place of the result lies in such a ball within it, so that no
/// wall is thinner than the ball, and outer edges are rounded. Narrow ends, and what is thinner, are gone.
Solid opened(const Solid& solid, double radius_mm, const Progress& progress = {});

/// What is printed of a solid: opened by `ball_mm`, evened out, so that its edges show no voxels, and opened by half of
/// `least_mm` once more, for necks between two balls that this left thin.
Solid with_walls(const Solid& solid, double ball_mm, double least_mm, const Progress& progress = {});

/// The solid, which must be in distances, with walls that are thinner than 2 `radius_mm` made so thick: balls of the
/// radius about the middle of each wall that a ball would not fit into. Sharp ridges are left as they are.
Solid thickened(const Solid& distances, double radius_mm, const Progress& progress = {});

/// Keeps the largest connected piece alone. Returns the volume of the rest.
double keep_largest(Solid& solid);

/// Its surface, valid (meshing/contour.h). Throws Error 80 as contour does.
surface::TriMesh surface_of(const Solid& solid, const Progress& progress = {});

}  // namespace trephine::print
