// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/result.h"

namespace trephine::surface {

/// Typed results: the figures that a case is made of and checked against. A stage that makes one adds it to its report
/// with add_result, and code that needs it reads it back with result_of; a missing figure is an error, never 0. Those
/// of deviation and mismatch are DeviationStats (metrics/deviation.h) and Mismatch (voxel/mismatch.h).

/// How far a stage that keeps a bound in mm moved the surface (decimate, remesh).
struct BoundResult {
  double deviation_max_mm = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&BoundResult::deviation_max_mm, "deviation_max_mm", Range{}, "Largest distance to the input.");
  }
};

/// Why a reduction ended (decimate).
struct DecimationResult {
  std::string stopped_by;
  template <class V>
  static void describe(V& v) {
    v.text(&DecimationResult::stopped_by, "stopped_by", "The limit at which the reduction ended.");
  }
};

/// How far smoothing moved the surface.
struct SmoothingResult {
  double displacement_max_mm = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&SmoothingResult::displacement_max_mm, "displacement_max_mm", Range{}, "Largest displacement of a point.");
  }
};

/// A surface as a contour makes it.
struct ContourResult {
  std::int64_t triangles_count = 0;
  template <class V>
  static void describe(V& v) {
    v.integer(&ContourResult::triangles_count, "triangles_count", Range{}, "Count of its triangles.");
  }
};

/// A shape of the haptic volume (voxelize, by the shape's name).
struct ShapeVolumeResult {
  double volume_ml = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&ShapeVolumeResult::volume_ml, "volume_ml", Range{}, "Volume that is left of the shape.");
  }
};

/// What a cutter removed (boolean and voxelize, by the cutter's name and the shape's).
struct RemovedResult {
  double removed_mm3 = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&RemovedResult::removed_mm3, "removed_mm3", Range{}, "Volume removed.");
  }
};

}  // namespace trephine::surface
