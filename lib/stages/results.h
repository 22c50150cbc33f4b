// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/result.h"

namespace trephine {

/// Typed results of stages: what a case is made of and held against. A stage adds them to its report with add_result;
/// who needs them takes them back with result_of, and a figure that is missing is an error, never 0.

/// Two-sided distances between a finished surface and the unreduced one (measure).
struct DeviationResult {
  double max_mm = 0, p99_mm = 0, rms_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = DeviationResult;
    v.number(&P::max_mm, "deviation_max_mm", Range{}, "Largest.");
    v.number(&P::p99_mm, "deviation_p99_mm", Range{}, "99th percentile.");
    v.number(&P::rms_mm, "deviation_rms_mm", Range{}, "Root mean square.");
  }
};

/// How far a stage that keeps a bound in mm moved the surface (decimate, remesh).
struct BoundResult {
  double deviation_max_mm = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&BoundResult::deviation_max_mm, "deviation_max_mm", Range{}, "Largest distance to the input.");
  }
};

/// What ended a reduction (decimate).
struct DecimationResult {
  std::string stopped_by;
  template <class V>
  static void describe(V& v) {
    v.text(&DecimationResult::stopped_by, "stopped_by", "The limit that ended it.");
  }
};

/// How far smoothing moved the surface.
struct SmoothingResult {
  double displacement_max_mm = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&SmoothingResult::displacement_max_mm, "displacement_max_mm", Range{}, "Largest way of a point.");
  }
};

/// A surface as a contour makes it.
struct ContourResult {
  std::int64_t triangles_count = 0;
  template <class V>
  static void describe(V& v) {
    v.integer(&ContourResult::triangles_count, "triangles_count", Range{}, "Its triangles.");
  }
};

/// A shape of the haptic volume (voxelize, by the shape's name).
struct ShapeVolumeResult {
  double volume_ml = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&ShapeVolumeResult::volume_ml, "volume_ml", Range{}, "What is left of it.");
  }
};

/// What a cutter took away (boolean and voxelize, by the cutter's name and the shape's).
struct RemovedResult {
  double removed_mm3 = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&RemovedResult::removed_mm3, "removed_mm3", Range{}, "Volume removed.");
  }
};

/// How far what is felt lies from what is seen (mismatch, by the shape's name).
struct MismatchResult {
  double bias_mm = 0, rms_mm = 0, p99_mm = 0, max_mm = 0, missed_ratio = 0;
  std::int64_t samples_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = MismatchResult;
    v.number(&P::bias_mm, "mismatch_bias_mm", Range{}, "Mean, positive outside.");
    v.number(&P::rms_mm, "mismatch_rms_mm", Range{}, "Root mean square.");
    v.number(&P::p99_mm, "mismatch_p99_mm", Range{}, "99th percentile.");
    v.number(&P::max_mm, "mismatch_max_mm", Range{}, "Largest.");
    v.number(&P::missed_ratio, "mismatch_missed_ratio", Range{}, "Share of the samples without a felt surface nearby.");
    v.integer(&P::samples_count, "mismatch_samples_count", Range{}, "Samples.");
  }
};

}  // namespace trephine
