// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "boolean/cutter.h"
#include "surface/trimesh.h"

namespace trephine {

struct CutSurfaceParams {
  double cutter_deviation_mm = 0.05;
  double min_component_mm3 = 50;
  double time_limit_s = 60;
  template <class V>
  static void describe(V& v) {
    using P = CutSurfaceParams;
    v.number(&P::cutter_deviation_mm, "cutter_deviation_mm", Range{0.001, 1},
             "How far the cutter's facets may lie from its true surface.");
    v.number(&P::min_component_mm3, "min_component_mm3", Range{0, 1e9},
             "Loose pieces smaller than this that the cut leaves are dropped.");
    v.number(&P::time_limit_s, "time_limit_s", Range{0.1, 3600},
             "Wall clock for the boolean; beyond it it is refused.");
  }
};

/// The surface without the cutters, one after the other: exact corefinement (CGAL polygon mesh processing) in the
/// bounded child, only of the part of the surface near the cutter; operands and result are checked. The result is
/// closed, 2-manifold, outwards oriented, free of self-intersections and degenerate triangles, also in float32
/// (validity.h); normals are recomputed where the input had them. Where a cut is degenerate (facets that coincide, a
/// tangent cutter) the cutter is turned about its axis, then moved, by the least step that gives a valid result
/// (reported, at most cutter_deviation_mm). The report: cutters_count, removed_mm3, cutter by cutter removed_mm3 and
/// removed_expected_mm3 (the exact volume of cutter and surface, by an independent way), triangles_count, moved_mm.
///
/// Throws Error 65 where the surface or a cutter is not finite; 80 where the surface is not valid, nothing is left of
/// it, no valid result can be had, or the removed volume differs from the expected one by more than 1 % and 0.5 mm^3;
/// Cancelled. A child that dies or runs over its limits is 80 too, naming it.
TriMesh cut_surface(const TriMesh& surface, const std::vector<Cutter>& cutters, const CutSurfaceParams& params,
                    Report& report, const Progress& progress = {});

}  // namespace trephine
