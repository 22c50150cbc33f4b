// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "surface/trimesh.h"

namespace trephine {

struct SmoothParams {
  std::int64_t iterations_count = 10;
  double pass_band_ratio = 1.0;
  double max_displacement_mm = 0.1;
  template <class V>
  static void describe(V& v) {
    using P = SmoothParams;
    v.integer(&P::iterations_count, "iterations_count", Range{0, 100000},
              "Degree of the filter; 0 leaves the mesh as it is.");
    v.number(&P::pass_band_ratio, "pass_band_ratio", Range{1e-4, 2},
             "Highest frequency of the mesh that passes: 2 passes all; 1 takes the unevenness of a decimated surface "
             "away, 0.1 smooths a dense one visibly.");
    v.number(&P::max_displacement_mm, "max_displacement_mm", Range{0, 1e6}, "No point moves further than this.");
  }
};

/// Low-pass filter of the points (windowed sinc; Taubin, Zhang, Golub 1996), of which each takes the part along its
/// normal, with an even offset that gives back the volume, cut off at max_displacement_mm. The triangles stay as they
/// are; normals are dropped. Where the result would intersect itself or hold a degenerate triangle, the points around
/// it go back to where they were, and are counted. Reported: the largest and RMS displacement, the change of volume in
/// percent, and the points held back.
///
/// Throws Error 65 where the mesh is not finite or its indices are out of range; 80 where it is not closed and
/// 2-manifold, or intersects itself already.
TriMesh smooth(const TriMesh& mesh, const SmoothParams& params, Report& report, const Progress& progress = {});

}  // namespace trephine
