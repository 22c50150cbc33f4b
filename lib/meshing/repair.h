// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
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
surface::TriMesh repair(const surface::TriMesh& mesh, const RepairParams& params, Report& report,
                        const Progress& progress = {});

}  // namespace trephine::meshing
