// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "base/params.h"
#include "base/progress.h"
#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine::voxel {

/// Where a contact with the volume lies: where the shape's trilinear occupancy is 1/2, or at the faces of the voxels of
/// which the shape has at least half.
enum class FeltSurface { sub_voxel, nearest };

struct MismatchParams {
  int sample_count = 20000;
  double reach_mm = 3;
  FeltSurface felt = FeltSurface::sub_voxel;
  template <class V>
  static void describe(V& v) {
    using P = MismatchParams;
    v.integer(&P::sample_count, "sample_count", Range{100, 100000000}, "Count of points on the displayed surface.");
    v.number(&P::reach_mm, "reach_mm", Range{0.01, 100}, "How far along the normal the felt surface is searched for.");
    v.choice(&P::felt, "felt", {{"sub_voxel", FeltSurface::sub_voxel}, {"nearest", FeltSurface::nearest}},
             "Which surface of the volume is felt. sub_voxel: that between the voxels' values; nearest: the voxels' "
             "own faces.");
  }
};

/// Offsets along the displayed surface's normals, positive where the felt surface lies outside of it.
struct Mismatch {
  double bias_mm = 0, rms_mm = 0, p99_mm = 0,
         max_mm = 0;        ///< of the samples where it was found; p99 and max are absolute
  double missed_ratio = 0;  ///< share of the samples where it was not found
  std::size_t samples = 0;  ///< samples that lie within the volume by at least a voxel
  template <class V>
  static void describe(V& v) {  // as figures of a report (base/result.h)
    using P = Mismatch;
    v.number(&P::bias_mm, "mismatch_bias_mm", Range{}, "Mean offset, positive outside.");
    v.number(&P::rms_mm, "mismatch_rms_mm", Range{}, "Root mean square of the offsets.");
    v.number(&P::p99_mm, "mismatch_p99_mm", Range{}, "99th percentile of the offsets.");
    v.number(&P::max_mm, "mismatch_max_mm", Range{}, "Largest.");
    v.number(&P::missed_ratio, "mismatch_missed_ratio", Range{}, "Share of the samples without a felt surface nearby.");
    v.integer(&P::samples, "mismatch_samples_count", Range{}, "Samples.");
  }
};

/// The stage's result, by shape.
struct MismatchResult {
  Named<Mismatch> shapes;
  template <class V>
  static void describe(V& v) {
    v.map(&MismatchResult::shapes, "shapes", "By shape.").items_alone();
  }
};

/// Takes points spread evenly over the displayed surface (closed or not; the same whatever the thread count), and looks
/// along the triangle's normal for the place nearest to the point, within reach_mm, where one leaves the shape as
/// `felt` defines it. Only a crossing outwards counts, so the far side of a thin wall, or the boundary to a shape
/// within, is not taken for the displayed surface. Where another shape of the volume took a part of this one, nothing
/// is felt there: the sample is missed, or counts with its offset. Throws Error 65 as check_mesh does.
Mismatch measure_mismatch(const surface::TriMesh& displayed, const HapticVolume& volume, const HapticShape& shape,
                          const MismatchParams& params = {}, const Progress& progress = {});

}  // namespace trephine::voxel
