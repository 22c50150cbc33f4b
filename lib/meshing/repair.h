// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

struct RepairParams {
  double merge_mm = 0.01;
  double min_component_mm3 = 0;
  std::int64_t recontour_voxels_count = 192;
  double time_limit_s = 60;
  double total_limit_s = 900;
  template <class V>
  static void describe(V& v) {
    using P = RepairParams;
    v.number(&P::merge_mm, "merge_mm", Range{0, 10},
             "Points at open edges that are nearer than this (and than 0.001 of the mean edge) are merged.");
    v.number(&P::min_component_mm3, "min_component_mm3", Range{0, 1e9},
             "Separate pieces below this volume are left out; the largest piece always stays.");
    v.integer(&P::recontour_voxels_count, "recontour_voxels_count", Range{0, 1000},
              "Last resort: a new surface from the winding number, on this many voxels along the longest side. Edges "
              "become rounded, and parts thinner than a voxel vanish. 0: refuse instead.");
    v.number(&P::time_limit_s, "time_limit_s", Range{0.1, 3600},
             "Limit on the wall clock time of the repair in place; after it the last resort is used.");
    v.number(&P::total_limit_s, "total_limit_s", Range{0.1, 86400},
             "Limit on the wall clock time of all of it, the last resort included; after it the repair is given up "
             "(exit code 70).");
  }
};

/// What is printed of a repair.
struct RepairResult {
  std::string method;
  std::size_t triangles_count = 0;
  std::size_t points_merged_count = 0;
  std::size_t triangles_dropped_count = 0;
  std::size_t duplicates_dropped_count = 0;
  std::size_t fins_dropped_count = 0;
  std::size_t sheets_dropped_count = 0;
  std::size_t flipped_count = 0;
  std::size_t points_split_count = 0;
  std::size_t holes_filled_count = 0;
  std::size_t degenerate_removed_count = 0;
  std::size_t self_intersections_found_count = 0;
  std::size_t united_count = 0;
  std::size_t components_dropped_count = 0;
  double voxel_mm = 0;
  double volume_ml = 0;
  double to_input_max_mm = 0;
  double from_input_max_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = RepairResult;
    v.text(&P::method, "method", "How it was repaired.");
    v.integer(&P::triangles_count, "triangles_count", Range{}, "Triangles.");
    v.integer(&P::points_merged_count, "points_merged_count", Range{}, "Points merged.");
    v.integer(&P::triangles_dropped_count, "triangles_dropped_count", Range{},
              "Triangles without area that were dropped.");
    v.integer(&P::duplicates_dropped_count, "duplicates_dropped_count", Range{}, "Duplicates dropped.");
    v.integer(&P::fins_dropped_count, "fins_dropped_count", Range{}, "Fins dropped.");
    v.integer(&P::sheets_dropped_count, "sheets_dropped_count", Range{}, "Sheets dropped.");
    v.integer(&P::flipped_count, "flipped_count", Range{}, "Triangles flipped.");
    v.integer(&P::points_split_count, "points_split_count", Range{}, "Points split.");
    v.integer(&P::holes_filled_count, "holes_filled_count", Range{}, "Holes filled.");
    v.integer(&P::degenerate_removed_count, "degenerate_removed_count", Range{}, "Degenerate triangles removed.");
    v.integer(&P::self_intersections_found_count, "self_intersections_found_count", Range{},
              "Self-intersections found.");
    v.integer(&P::united_count, "united_count", Range{}, "Pieces united.");
    v.integer(&P::components_dropped_count, "components_dropped_count", Range{}, "Components dropped.");
    v.number(&P::voxel_mm, "voxel_mm", Range{}, "Voxel of the repair by volume; 0: none.");
    v.number(&P::volume_ml, "volume_ml", Range{}, "Volume.");
    v.number(&P::to_input_max_mm, "to_input_max_mm", Range{}, "Largest distance to the input.");
    v.number(&P::from_input_max_mm, "from_input_max_mm", Range{}, "Largest distance of the input to it.");
  }
};

/// Makes a triangle soup of another program into the surface that every stage needs: closed, 2-manifold, oriented
/// outwards, free of self-intersections and degenerate triangles, also in float32 (validity.h). Normals are dropped. A
/// valid mesh is returned as it is, on float32's raster ("method" none).
///
/// Repair in place (method "mended") begins with the soup: equal points are merged, triangles with a repeated point and
/// duplicate triangles are removed, fins and open sheets are removed, triangles are turned to face the same way as most
/// of their neighbours, and edges and points that more than one sheet shares are separated. Then, in the bounded child
/// (CGAL polygon mesh processing), degenerate triangles are removed, borders stitched, holes filled, slivers collapsed,
/// self-intersections cut out and filled, and overlapping pieces united. Where pairs of triangles crossed, the result
/// must enclose the space that the soup's winding number encloses, to within 5 %. A piece that lies in no other is
/// oriented outwards; a piece within another keeps the side that most of its triangles face (a cavity stays one).
///
/// Where the result is not valid, or the child dies or exceeds its limit, the last resort is used (method
/// "recontoured"): a new surface where the generalized winding number ([Jacobson2013]; computed by the fast method of
/// [Barill2018]) is 1/2, contoured on recontour_voxels_count voxels along the longest side; a warning says so.
///
/// The report: method; counts of all repairs (points_merged_count, triangles_dropped_count, duplicates_dropped_count,
/// fins_dropped_count, sheets_dropped_count, flipped_count, points_split_count, holes_filled_count,
/// degenerate_removed_count, self_intersections_found_count, united_count, components_dropped_count), voxel_mm,
/// triangles_count, volume_ml, and how far the result lies from the input and the input from the result at their points
/// and triangle centres (to_input_max_mm includes filled holes; from_input_max_mm includes dropped parts).
///
/// Throws Error 65 where the mesh is not finite, has indices out of range or no triangles; 80 where no valid surface
/// can be made; 70 where the child reached its limit of time or memory and the last resort is turned off, or where all
/// of it takes longer than total_limit_s; Cancelled.
/// The result has the same bytes whatever the thread count.
Outcome<surface::TriMesh, RepairResult> repair(const surface::TriMesh& mesh, const RepairParams& params,
                                               const Progress& progress = {});

}  // namespace trephine::meshing
