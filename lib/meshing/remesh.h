// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "surface/trimesh.h"

namespace trephine {

struct RemeshParams {
  double edge_mm = 0;
  std::int64_t iterations_count = 5;
  double feature_angle_deg = 180;
  double max_deviation_mm = 0.3;
  double time_limit_s = 300;
  template <class V>
  static void describe(V& v) {
    using P = RemeshParams;
    v.number(&P::edge_mm, "edge_mm", Range{0, 1000}, "Edge length aimed at; 0: the input's mean.");
    v.integer(&P::iterations_count, "iterations_count", Range{1, 50}, "How often edges are split, joined and turned.");
    v.number(&P::feature_angle_deg, "feature_angle_deg", Range{1, 180},
             "Edges at which the surface turns by more stay; 180: none.");
    v.number(&P::max_deviation_mm, "max_deviation_mm", Range{1e-6, 1e6},
             "Largest distance between the surface and the input, either way; the edge is shortened to keep it.");
    v.number(&P::time_limit_s, "time_limit_s", Range{0.1, 3600}, "Wall clock; beyond it remeshing is refused.");
  }
};

/// The same surface of even triangles, near equilateral and with edges of about edge_mm (Botsch, Kobbelt 2004; CGAL's
/// isotropic remeshing in the bounded child), every point projected onto the input. For consumers that want it, as
/// finite elements do; decimation gives a smaller deviation at the same count.
///
/// The result is closed, 2-manifold and free of self-intersections, also in float32 (validity.h); where it is not, or
/// lies further than max_deviation_mm from the input or the input from it (points and triangles' middles of both), the
/// edge is shortened to 0.7 of itself and all is done again, four times at most; the report's tries_count says how
/// often. Reported too: edge_mm as it ended, triangles_count, deviation_max_mm, edge_{min,mean,max}_mm, angle_min_deg
/// (the mean of the triangles' least angles: 60 is best), volume_change_percent. The same bytes whatever the threads.
///
/// Throws Error 65 where the mesh is not finite or its indices are out of range; 80 where it is not valid, or no try
/// was good enough; 70 where the child dies or runs longer than time_limit_s; Cancelled.
TriMesh remesh(const TriMesh& mesh, const RemeshParams& params, Report& report, const Progress& progress = {});

}  // namespace trephine
