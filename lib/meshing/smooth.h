// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

enum class SmoothMethod { windowed_sinc, laplacian, feature };

struct SmoothParams {
  SmoothMethod method = SmoothMethod::windowed_sinc;
  std::int64_t iterations_count = 10;
  double pass_band_ratio = 1.0;
  double feature_angle_deg = 30;
  double max_displacement_mm = 0.1;
  double max_volume_change_percent = 0.5;
  double total_deviation_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = SmoothParams;
    v.choice(&P::method, "method",
             {{"windowed_sinc", SmoothMethod::windowed_sinc},
              {"laplacian", SmoothMethod::laplacian},
              {"feature", SmoothMethod::feature}},
             "windowed_sinc: low-pass filter; laplacian: mean of the neighbours; feature: filtered normals, which keep "
             "sharp edges.");
    v.integer(&P::iterations_count, "iterations_count", Range{0, 100000},
              "Degree of the filter, or how often it is applied; 0 leaves the mesh as it is.");
    v.number(&P::pass_band_ratio, "pass_band_ratio", Range{1e-4, 2},
             "windowed_sinc: highest frequency of the mesh that passes. 2 passes all; 1 removes the unevenness of a "
             "decimated surface; 0.1 smooths a dense surface visibly.");
    v.number(&P::feature_angle_deg, "feature_angle_deg", Range{1, 180},
             "feature: edges sharper than about this are kept.");
    v.number(&P::max_displacement_mm, "max_displacement_mm", Range{0, 1e6}, "No point moves further than this.");
    v.number(&P::max_volume_change_percent, "max_volume_change_percent", Range{0, 100},
             "Where the volume would change by more than this, all points move less.");
    v.number(&P::total_deviation_mm, "total_deviation_mm", Range{0, 1e6},
             "With a reference, such as the surface before it was decimated: the largest distance from it to the "
             "result, in either direction; points that would break it stay. 0: no such limit.");
  }
};

/// What is printed of a smoothing.
struct SmoothResult {
  std::size_t triangles_count = 0;
  double displacement_max_mm = 0;
  double displacement_rms_mm = 0;
  double strength_ratio = 1;
  double volume_ml = 0;
  double volume_change_percent = 0;
  std::optional<double> reference_distance_max_mm;
  std::optional<double> total_deviation_proven_mm;
  std::int64_t points_held_back_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = SmoothResult;
    v.integer(&P::triangles_count, "triangles_count", Range{}, "Triangles.");
    v.number(&P::displacement_max_mm, "displacement_max_mm", Range{}, "Largest displacement of a point.");
    v.number(&P::displacement_rms_mm, "displacement_rms_mm", Range{}, "Root mean square of the displacements.");
    v.number(&P::strength_ratio, "strength_ratio", Range{}, "Share of the movement that was taken.");
    v.number(&P::volume_ml, "volume_ml", Range{}, "Volume.");
    v.number(&P::volume_change_percent, "volume_change_percent", Range{}, "Change of volume.");
    v.number(&P::reference_distance_max_mm, "reference_distance_max_mm",
             "Largest distance to the reference, at points of the surfaces.");
    v.number(&P::total_deviation_proven_mm, "total_deviation_proven_mm",
             "Bound of the distance to the reference that was proven.");
    v.integer(&P::points_held_back_count, "points_held_back_count", Range{}, "Points that were held back.");
  }
};

/// Smooths a surface by one of three filters: a low-pass filter of the points (windowed sinc, [Taubin1996]), half-steps
/// towards the mean of the neighbours (Laplacian), or points fitted to filtered normals (feature_smooth.h). Of the
/// filter's movement each point takes the part along its normal, plus a uniform offset that restores the volume,
/// limited to max_displacement_mm. Where the volume still changes by more than max_volume_change_percent, the movement
/// is halved until it does not. The triangles stay as they are; normals are dropped. Where the result would intersect
/// itself or hold a degenerate triangle, the points around that place return to where they were, and are counted. The
/// report has the largest and RMS displacement, the share of the movement that was taken, the change of volume in
/// percent, and the count of points held back.
///
/// With a `reference` the report also has reference_distance_max_mm, the largest distance in either direction at points
/// of the surfaces; and where total_deviation_mm is set, no point of either surface lies further from the other
/// (prove_within.h), which the report repeats as total_deviation_proven_mm. So a chain of single tools keeps what was
/// asked of it as a whole.
///
/// Throws Error 64 where total_deviation_mm is set without a reference; 65 where a mesh is not finite or its indices
/// are out of range; 80 where it is not closed and 2-manifold, intersects itself already, or lies further from the
/// reference than total_deviation_mm before it is smoothed.
Outcome<surface::TriMesh, SmoothResult> smooth(const surface::TriMesh& mesh, const SmoothParams& params,
                                               const Progress& progress = {},
                                               const surface::TriMesh* reference = nullptr);

}  // namespace trephine::meshing
