// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

struct DecimateParams {
  std::int64_t target_triangles_count = 0;
  double keep_ratio = 0;
  double max_deviation_mm = 0.3;
  double input_within_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = DecimateParams;
    v.integer(&P::target_triangles_count, "target_triangles_count", Range{0, 1e9},
              "Stop at this many triangles; 0: no such limit.");
    v.number(&P::keep_ratio, "keep_ratio", Range{0, 1},
             "Stop at this share of the triangles; 0: no such limit. Of the two counts the larger one applies.");
    v.number(&P::max_deviation_mm, "max_deviation_mm", Range{0, 1e6},
             "Largest distance between the surface and the input, in either direction; 0: no such limit.");
    v.number(&P::input_within_mm, "input_within_mm", Range{0, 100},
             "How far the input may lie from what max_deviation_mm holds for, as `contour` merged triangles; 0: it is "
             "that itself.");
  }
  std::string fault() const;
};

/// What is printed of a decimation.
struct DecimateResult {
  std::size_t triangles_before_count = 0;
  std::size_t triangles_count = 0;
  double reduction_percent = 0;
  std::string stopped_by;
  double deviation_max_mm = 0;
  double deviation_p99_mm = 0;
  double deviation_rms_mm = 0;
  std::optional<double> deviation_proven_mm;
  double volume_change_percent = 0;
  std::size_t collapses_undone_count = 0;
  std::size_t collapses_undone_for_validity_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = DecimateResult;
    v.integer(&P::triangles_before_count, "triangles_before_count", Range{}, "Triangles before.");
    v.integer(&P::triangles_count, "triangles_count", Range{}, "Triangles.");
    v.number(&P::reduction_percent, "reduction_percent", Range{}, "By how much they are fewer.");
    v.text(&P::stopped_by, "stopped_by", "The limit at which the reduction ended.");
    v.number(&P::deviation_max_mm, "deviation_max_mm", Range{}, "Largest distance to the input.");
    v.number(&P::deviation_p99_mm, "deviation_p99_mm", Range{}, "99th percentile of the distances.");
    v.number(&P::deviation_rms_mm, "deviation_rms_mm", Range{}, "Root mean square of the distances.");
    v.number(&P::deviation_proven_mm, "deviation_proven_mm", "Bound that was proven.");
    v.number(&P::volume_change_percent, "volume_change_percent", Range{}, "Change of volume.");
    v.integer(&P::collapses_undone_count, "collapses_undone_count", Range{}, "Collapses that were undone.");
    v.integer(&P::collapses_undone_for_validity_count, "collapses_undone_for_validity_count", Range{},
              "Those of them that would have made the surface invalid.");
  }
};

/// Reduces the triangles of a surface by edge collapses in the order of their quadric error [Garland1997], until the
/// count is reached or every further collapse would exceed the deviation or make the surface invalid; the report's
/// stopped_by says "count", "deviation" or "validity". With no limit given, or where the input has no more triangles
/// than requested, the mesh is returned unchanged.
///
/// The result is closed, 2-manifold and free of self-intersections, also in float32 (validity.h): where collapses led
/// to an intersection, they are undone and counted. The deviation is two-sided. Every input point's distance to the
/// surface is tracked through the collapses, and at the end both directions are measured by samples (deviation_max_mm,
/// deviation_p99_mm, deviation_rms_mm, each the larger of the two directions): the input's points, the midpoints of its
/// edges and the centres of its triangles, and a raster over the result's triangles.
///
/// max_deviation_mm holds for every point of both surfaces, not for samples alone. Between samples it is proven from
/// the distances around (prove_within.h), in finer steps where they lie near the bound, and where the proof fails the
/// collapses are undone. The bound is exact except for the input's rounding to float32 (half a unit in the last place
/// of its coordinates about its origin, 4e-6 mm for a head). deviation_max_mm is the largest of the samples, which is
/// kept within 0.9 of the bound, so that few proofs fail. A point between samples can lie further, up to the bound,
/// which the report repeats as deviation_proven_mm. Where the input itself lies within input_within_mm of another
/// surface, max_deviation_mm holds for that one: only the rest of it is used here.
///
/// Throws Error 64 where input_within_mm is no less than max_deviation_mm; 65 where the mesh is not finite or its
/// indices are out of range; 80 where it is not closed, 2-manifold and free of self-intersections, or no limit can be
/// kept.
Outcome<surface::TriMesh, DecimateResult> decimate(const surface::TriMesh& mesh, const DecimateParams& params,
                                                   const Progress& progress = {});

}  // namespace trephine::meshing
