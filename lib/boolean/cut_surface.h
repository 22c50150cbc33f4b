// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "boolean/cutter.h"
#include "surface/trimesh.h"

namespace trephine::boolean {

struct CutSurfaceParams {
  double widen_mm = 0;
  double cutter_deviation_mm = 0.005;
  double rim_mm = 0.3;
  double min_component_mm3 = 50;
  double time_limit_s = 60;
  template <class V>
  static void describe(V& v) {
    using P = CutSurfaceParams;
    v.number(&P::widen_mm, "widen_mm", Range{0, 50}, "How much wider than their size the cutters cut, all around.");
    v.number(&P::cutter_deviation_mm, "cutter_deviation_mm", Range{0.001, 1},
             "How far the cutter's facets may lie from its true surface.");
    v.number(&P::rim_mm, "rim_mm", Range{0, 10},
             "Width of a ring of small triangles on both sides of the cut's sharp edges, so that smooth normals shade "
             "like a bevel of that width; 0: no ring.");
    v.number(&P::min_component_mm3, "min_component_mm3", Range{0, 1e9},
             "Loose pieces smaller than this that the cut leaves are dropped.");
    v.number(&P::time_limit_s, "time_limit_s", Range{0.1, 3600},
             "Limit on the wall clock time of the boolean; a cut that takes longer is refused.");
  }
};

/// What a cutter removed, and what the exact cutter and the surface have in common (by closed-form integration,
/// independent of the cut).
struct RemovedBySurface {
  double removed_mm3 = 0, removed_expected_mm3 = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&RemovedBySurface::removed_mm3, "removed_mm3", Range{}, "Volume removed.");
    v.number(&RemovedBySurface::removed_expected_mm3, "removed_expected_mm3", Range{}, "Volume to be removed.");
  }
};

struct CutSurfaceResult {
  std::size_t cutters_count = 0;
  double removed_mm3 = 0;
  Named<RemovedBySurface> cutters;  ///< one without a name is "cutter_1" and so on
  std::int64_t dropped_count = 0;
  double dropped_mm3 = 0;  ///< of loose pieces; not in removed_mm3
  double moved_mm = 0;
  std::int64_t tries_count = 0;  ///< 1 for each cutter that meets something
  std::size_t triangles_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = CutSurfaceResult;
    v.integer(&P::cutters_count, "cutters_count", Range{}, "Cutters.");
    v.number(&P::removed_mm3, "removed_mm3", Range{}, "Volume removed.");
    v.map(&P::cutters, "cutters", "By cutter.").items_alone();
    v.integer(&P::dropped_count, "dropped_count", Range{}, "Loose pieces that were dropped.");
    v.number(&P::dropped_mm3, "dropped_mm3", Range{}, "Their volume.");
    v.number(&P::moved_mm, "moved_mm", Range{}, "How far a cutter was moved for a valid result.");
    v.integer(&P::tries_count, "tries_count", Range{}, "Tries.");
    v.integer(&P::triangles_count, "triangles_count", Range{}, "Triangles.");
  }
};

/// Cuts the cutters out of the surface, one after the other, by exact corefinement (CGAL polygon mesh processing) of
/// the whole surface in the bounded child (0.1 s at 90,000 triangles). Triangles that the cut does not touch stay as
/// they are. The new points lie on float32's raster; details finer than 0.005 mm along the cut are merged. The result
/// is closed, 2-manifold, oriented outwards, free of self-intersections and degenerate triangles, also in float32
/// (validity.h); normals are recomputed where the input had them.
///
/// Where a cut is degenerate (facets that coincide, a tangent cutter), the cutter is first made a little slimmer, then
/// its facets are turned, then it is moved by the least step that gives a valid result (moved_mm, at most 0.05 mm). A
/// cutter that meets nothing gives a warning; where none meets anything, the result is the input (on float32's raster).
///
/// Throws Error 65 where the surface or a cutter is not finite or a cutter is not a solid; 80 where the surface is not
/// valid, nothing is left of it, no valid result can be found, or the removed volume differs from the expected one by
/// more than 1 % and 0.5 mm^3 (the line says where); 70 where the cuts take longer than time_limit_s (no child outlives
/// the call); Cancelled.
Outcome<surface::TriMesh, CutSurfaceResult> cut_surface(const surface::TriMesh& surface,
                                                        const std::vector<Cutter>& cutters,
                                                        const CutSurfaceParams& params, const Progress& progress = {});

/// The radius of the thickest probe that touches the surface nowhere. For a cylinder or cone the probe is a flat-ended
/// cylinder about the cutter's axis, from 0.1 mm inside its outer end to 0.1 mm before its far end; for a sphere, an
/// ellipsoid or a mesh it is a ball about the centre (for a mesh, of its bounds). Infinite where the surface does not
/// come near the axis between its ends; 0 where the axis meets the surface.
double free_radius_mm(const surface::TriMesh& surface, const Cutter& cutter);

}  // namespace trephine::boolean
