// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "base/params.h"
#include "base/progress.h"
#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine {

/// Where a contact with the volume lies: at the shape's trilinear occupancy of 1/2, or at the face of the voxels that
/// are at least half the shape's.
enum class FeltSurface { sub_voxel, nearest };

struct MismatchParams {
  int sample_count = 50000;
  double reach_mm = 3;
  FeltSurface felt = FeltSurface::sub_voxel;
  template <class V>
  static void describe(V& v) {
    using P = MismatchParams;
    v.integer(&P::sample_count, "sample_count", Range{100, 100000000}, "Points on the displayed surface.");
    v.number(&P::reach_mm, "reach_mm", Range{0.01, 100}, "How far along the normal the felt surface is looked for.");
    v.choice(&P::felt, "felt", {{"sub_voxel", FeltSurface::sub_voxel}, {"nearest", FeltSurface::nearest}},
             "Which surface of the volume is felt: that between the voxels' values, or the voxels' own faces.");
  }
};

/// Offsets along the displayed surface's normals, positive where the felt surface lies outside of it.
struct Mismatch {
  double bias_mm = 0, rms_mm = 0, p99_mm = 0, max_mm = 0;  ///< of the samples that found it; p99 and max absolute
  double missed_ratio = 0;                                 ///< share of the samples that did not
  std::size_t samples = 0;                                 ///< those within the volume by at least a voxel
  template <class V>
  static void describe(V& v) {  // as figures of a report (base/result.h)
    using P = Mismatch;
    v.number(&P::bias_mm, "mismatch_bias_mm", Range{}, "Mean, positive outside.");
    v.number(&P::rms_mm, "mismatch_rms_mm", Range{}, "Root mean square.");
    v.number(&P::p99_mm, "mismatch_p99_mm", Range{}, "99th percentile.");
    v.number(&P::max_mm, "mismatch_max_mm", Range{}, "Largest.");
    v.number(&P::missed_ratio, "mismatch_missed_ratio", Range{}, "Share of the samples without a felt surface nearby.");
    v.integer(&P::samples, "mismatch_samples_count", Range{}, "Samples.");
  }
};

/// For points spread evenly over the displayed surface (closed or not; the same whatever the thread count), where along
/// the triangle's normal the shape's surface, as `felt` has it, is left nearest to the point, within reach_mm. Only
/// outwards counts: the far side of a thin wall, or the boundary to a shape within, is not taken for the surface seen.
/// What another shape of the volume took from this one is not felt there: it is missed, or counts. Throws 65 as
/// check_mesh does.
Mismatch measure_mismatch(const TriMesh& displayed, const HapticVolume& volume, const HapticShape& shape,
                          const MismatchParams& params = {}, const Progress& progress = {});

}  // namespace trephine
