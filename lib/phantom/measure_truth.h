// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "metrics/field.h"
#include "metrics/measure.h"
#include "phantom/truth.h"
#include "surface/trimesh.h"

namespace trephine::phantom {

/// One anatomy of a phantom's truth, ready for many comparisons.
struct TruthSurface {
  const Truth* truth = nullptr;  ///< must outlive this
  Anatomy anatomy = Anatomy::skin;
  surface::TriMesh mesh;  ///< truth_mesh with a step of 1 mm
};
TruthSurface truth_surface(const Truth& truth, Anatomy anatomy, const Progress& progress = {});

/// A surface against the analytic one, as measure_surface with a TruthReference. Where the scan ends the surface is
/// capped, and nothing is known of the cap's truth: 3 mm of it are left out.
Outcome<std::monostate, metrics::MeasureResult> measure_against_truth(const surface::TriMesh& surface,
                                                                      const TruthSurface& truth,
                                                                      const metrics::MeasureParams& params,
                                                                      const Progress& progress = {});

/// A field against the truth's solid on the field's own voxels, as far as the scan reached: measure_field, of a skull
/// also how much too thick it is; at level hard also how much apparatus and how much of the cervical vertebrae it
/// holds.
metrics::FieldMeasures measure_against_truth(const grid::Field& field, const TruthSurface& truth, int sample_count,
                                             const Progress& progress = {});

}  // namespace trephine::phantom
