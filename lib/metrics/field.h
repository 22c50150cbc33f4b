// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <optional>

#include "base/params.h"
#include "base/progress.h"
#include "grid/grid.h"
#include "metrics/deviation.h"
#include "surface/distance_function.h"
#include "surface/trimesh.h"

namespace trephine::metrics {

/// What a field is measured against. The objects behind the pointers must outlive the call.
struct FieldTruth {
  const grid::Mask* solid =
      nullptr;  ///< 1 inside, on the field's raster (perhaps on more of it); the two are compared only there
  surface::DistanceFunction distance;           ///< to the truth's surface, negative inside
  const surface::TriMesh* mesh = nullptr;       ///< the truth's own surface
  std::function<bool(Vec3 world_mm)> is_inner;  ///< null, or whether a point near the truth's surface belongs to its
                                                ///< inner side: a shell's thickness is then measured
  KnownRegion within;                           ///< where distances are taken
};

/// What was measured of a shell: how far its inner and outer surface lie outside of the truth's, from the surface's
/// points, and how much too thick it is, their sum.
struct ShellFigures {
  double inner_bias_mm = 0, outer_bias_mm = 0, width_bias_mm = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&ShellFigures::inner_bias_mm, "inner_bias_mm", Range{}, "How far the inner surface lies outside.");
    v.number(&ShellFigures::outer_bias_mm, "outer_bias_mm", Range{}, "How far the outer surface lies outside.");
    v.number(&ShellFigures::width_bias_mm, "width_bias_mm", Range{}, "How much too thick the shell is.");
  }
};

/// Volumes and Dice of the voxels whose centres lie inside; distances between the field's surface at 0 and the truth's.
struct FieldMeasures {
  double dice_ratio = 0, volume_ml = 0, reference_volume_ml = 0, volume_difference_ratio = 0;
  Deviation deviation;
  std::optional<ShellFigures> shell;
  std::optional<double> apparatus_ml, vertebrae_ml;  ///< of a hard phantom: what of them the field holds
  template <class V>
  static void describe(V& v) {
    using P = FieldMeasures;
    v.number(&P::dice_ratio, "dice_ratio", Range{}, "Dice coefficient.");
    v.number(&P::volume_ml, "volume_ml", Range{}, "Volume.");
    v.number(&P::reference_volume_ml, "reference_volume_ml", Range{}, "The truth's volume.");
    v.number(&P::volume_difference_ratio, "volume_difference_ratio", Range{}, "Difference, as a share of that.");
    v.all_of(&P::deviation);
    v.all_of(&P::shell);
    v.number(&P::apparatus_ml, "apparatus_ml", "Apparatus that the field holds.");
    v.number(&P::vertebrae_ml, "vertebrae_ml", "Cervical vertebrae that it holds.");
  }
};

/// Measures a field (positive inside) against a known shape, with sample_count points on each side; a shell where
/// is_inner is given. Throws Error 65 where the rasters differ or
/// nothing can be measured, 80 as contour() does.
FieldMeasures measure_field(const grid::Field& field, const FieldTruth& truth, int sample_count,
                            const Progress& progress = {});

}  // namespace trephine::metrics
