// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

struct ContourParams {
  double isovalue_hu = 226.5;
  double min_component_mm3 = 50;
  bool keep_cavities = false;
  double within_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = ContourParams;
    v.number(&P::isovalue_hu, "isovalue_hu", Range{-32768, 65535},
             "HU at which the surface lies; only for CT volumes, a field's surface lies at 0.");
    v.number(&P::min_component_mm3, "min_component_mm3", Range{0, 1e9},
             "Separate pieces below this volume are left out; the largest piece always stays.");
    v.flag(&P::keep_cavities, "keep_cavities",
           "Keep the inner surfaces of enclosed cavities, and everything within them.");
    v.number(&P::within_mm, "within_mm", Range{0, 100},
             "Triangles are merged where the surface then lies within this of what it was, in either direction; 0: "
             "nowhere.");
  }
};

/// Of a surface whose triangles were merged.
struct MergedFigures {
  double within_proven_mm = 0;
  std::size_t triangles_before_count = 0, boxes_divided_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = MergedFigures;
    v.number(&P::within_proven_mm, "within_proven_mm", Range{}, "How far the merged surface lies off at most, proven.");
    v.integer(&P::triangles_before_count, "triangles_before_count", Range{}, "Triangles before they were merged.");
    v.integer(&P::boxes_divided_count, "boxes_divided_count", Range{},
              "Boxes that were divided again, so that the surface is valid.");
  }
};

/// What is printed of a contour.
struct ContourResult {
  std::optional<double> isovalue_hu;
  std::size_t inside_voxels_count = 0;
  std::size_t triangles_count = 0;
  std::size_t points_count = 0;
  double volume_ml = 0;
  std::size_t components_count = 0;
  std::int64_t genus_count = 0;
  std::int64_t small_components_dropped_count = 0;
  std::int64_t cavities_dropped_count = 0;
  std::size_t points_drawn_in_count = 0;
  std::optional<MergedFigures> merged;
  template <class V>
  static void describe(V& v) {
    using P = ContourResult;
    v.number(&P::isovalue_hu, "isovalue_hu", "Isovalue of a CT volume, as it was used.");
    v.integer(&P::inside_voxels_count, "inside_voxels_count", Range{}, "Voxels inside.");
    v.integer(&P::triangles_count, "triangles_count", Range{}, "Triangles.");
    v.integer(&P::points_count, "points_count", Range{}, "Points.");
    v.number(&P::volume_ml, "volume_ml", Range{}, "Volume.");
    v.integer(&P::components_count, "components_count", Range{}, "Connected components.");
    v.integer(&P::genus_count, "genus_count", Range{}, "Genus.");
    v.integer(&P::small_components_dropped_count, "small_components_dropped_count", Range{},
              "Small components that were dropped.");
    v.integer(&P::cavities_dropped_count, "cavities_dropped_count", Range{}, "Cavities that were dropped.");
    v.integer(&P::points_drawn_in_count, "points_drawn_in_count", Range{},
              "Points that were drawn in, so that the surface is valid.");
    v.all_of(&P::merged);
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
/// Where within_mm is not 0, triangles are merged (surface/cell_merge.h): flat parts have fewer, and the surface
/// lies within that bound of marching cubes' own, which is proven. Components and genus are the same, and every point
/// is one of marching cubes', but for those that float32 needs elsewhere, whose way counts in within_proven_mm.
///
/// Throws Error 80, naming the count of inside voxels, where no voxel, every voxel or only voxels of a single slice are
/// inside; 65 where a sample is not finite; 80 where no valid surface can be made.
Outcome<surface::TriMesh, ContourResult> contour(const grid::Field& field, const ContourParams& params,
                                                 const Progress& progress = {});
Outcome<surface::TriMesh, ContourResult> contour(const grid::HuVolume& volume, const ContourParams& params,
                                                 const Progress& progress = {});
/// The surface of a field to be looked at: the same but for a few points, with all pieces and cavities, and not looked
/// through for self-intersections, which takes as long as all the rest. Throws as contour() does where there is no
/// surface.
surface::TriMesh contour_to_look_at(const grid::Field& field, const Progress& progress = {});

}  // namespace trephine::meshing
