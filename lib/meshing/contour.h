// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "grid/grid.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

struct ContourParams {
  double isovalue_hu = 226.5;
  double min_component_mm3 = 50;
  bool keep_cavities = false;
  template <class V>
  static void describe(V& v) {
    using P = ContourParams;
    v.number(&P::isovalue_hu, "isovalue_hu", Range{-32768, 65535},
             "HU at which the surface lies; only for CT volumes, a field's surface lies at 0.");
    v.number(&P::min_component_mm3, "min_component_mm3", Range{0, 1e9},
             "Separate pieces below this volume are left out; the largest piece always stays.");
    v.flag(&P::keep_cavities, "keep_cavities",
           "Keep the inner surfaces of enclosed cavities, and everything within them.");
  }
};

/// The surface of a field (at 0, positive inside) or of a CT volume (at isovalue_hu, denser inside). It is closed,
/// 2-manifold, oriented outwards whatever the lattice's handedness, and free of self-intersections and degenerate
/// triangles, all of that also in float32 (validity.h). Everything beyond the lattice is outside: an anatomy that the
/// border cuts is capped half a voxel outside the last voxel's centre. The mesh's origin is the centre of its bounds,
/// rounded to whole mm.
///
/// The method is marching cubes [Lorensen1987]. The faces of ambiguous cells are joined as the bilinear interpolant
/// says [Nielson1991], and no diagonal lies in a cell's face. Points keep a distance of 0.002 of a lattice edge from
/// its ends, and more (up to 0.05) in the few places where float32 needs it: the surface may lie that far from the
/// interpolated one, and samples equal to the isovalue do no harm. In integer volumes an integer isovalue is lowered by
/// 1/2, so that a voxel of exactly that value is inside; the report's isovalue_hu is the effective one.
///
/// Throws Error 80, naming the count of inside voxels, where no voxel, every voxel or only voxels of a single slice are
/// inside; 65 where a sample is not finite; 80 where no valid surface can be made.
surface::TriMesh contour(const grid::Field& field, const ContourParams& params, Report& report,
                         const Progress& progress = {});
surface::TriMesh contour(const grid::HuVolume& volume, const ContourParams& params, Report& report,
                         const Progress& progress = {});
/// The surface of a field to be looked at: the same but for a few points, with all pieces and cavities, and not looked
/// through for self-intersections, which takes as long as all the rest. Throws as contour() does where there is no
/// surface.
surface::TriMesh contour_to_look_at(const grid::Field& field, const Progress& progress = {});

}  // namespace trephine::meshing
