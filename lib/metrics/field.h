// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "base/progress.h"
#include "base/report.h"
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

/// Measures a field (positive inside) against a known shape. The voxels whose centres lie inside give dice_ratio,
/// volume_ml, reference_volume_ml and volume_difference_ratio. The distances between the field's surface at 0 and the
/// truth's surface give deviation_{max,p99,rms,mean,bias}_mm, to_reference_..., from_reference_...
/// (metrics/deviation.h, over sample_count points on each side) and samples_count. With is_inner the result also has
/// inner_bias_mm and outer_bias_mm (positive where the surface lies outside of the truth's, from the surface's points)
/// and their sum, width_bias_mm, which is how much too thick the shell is. Throws Error 65 where the rasters differ or
/// nothing can be measured, 80 as contour() does.
Report measure_field(const grid::Field& field, const FieldTruth& truth, int sample_count,
                     const Progress& progress = {});

}  // namespace trephine::metrics
