// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

struct RemeshParams {
  double edge_mm = 0;
  std::int64_t iterations_count = 5;
  double feature_angle_deg = 180;
  double max_deviation_mm = 0.3;
  double time_limit_s = 300;
  template <class V>
  static void describe(V& v) {
    using P = RemeshParams;
    v.number(&P::edge_mm, "edge_mm", Range{0, 1000}, "Target edge length; 0: the input's mean.");
    v.integer(&P::iterations_count, "iterations_count", Range{1, 50},
              "How often edges are split, collapsed and flipped.");
    v.number(&P::feature_angle_deg, "feature_angle_deg", Range{1, 180},
             "Edges at which the surface turns by more than this are kept; 180: none.");
    v.number(
        &P::max_deviation_mm, "max_deviation_mm", Range{1e-6, 1e6},
        "Largest distance between the surface and the input, in either direction; the edge is shortened to keep it.");
    v.number(&P::time_limit_s, "time_limit_s", Range{0.1, 3600},
             "Limit on the wall clock time; remeshing that takes longer is refused.");
  }
};

/// What is printed of a remeshing.
struct RemeshResult {
  std::size_t triangles_count = 0;
  double edge_mm = 0;
  std::int64_t tries_count = 0;
  double deviation_max_mm = 0;
  double edge_min_mm = 0;
  double edge_mean_mm = 0;
  double edge_max_mm = 0;
  double angle_min_deg = 0;
  double volume_change_percent = 0;
  template <class V>
  static void describe(V& v) {
    using P = RemeshResult;
    v.integer(&P::triangles_count, "triangles_count", Range{}, "Triangles.");
    v.number(&P::edge_mm, "edge_mm", Range{}, "Edge that was aimed at.");
    v.integer(&P::tries_count, "tries_count", Range{}, "Tries.");
    v.number(&P::deviation_max_mm, "deviation_max_mm", Range{}, "Largest distance to the input.");
    v.number(&P::edge_min_mm, "edge_min_mm", Range{}, "Shortest edge.");
    v.number(&P::edge_mean_mm, "edge_mean_mm", Range{}, "Mean edge.");
    v.number(&P::edge_max_mm, "edge_max_mm", Range{}, "Longest edge.");
    v.number(&P::angle_min_deg, "angle_min_deg", Range{}, "Mean of the least angles.");
    v.number(&P::volume_change_percent, "volume_change_percent", Range{}, "Change of volume.");
  }
};

/// Gives the same surface even triangles, near equilateral and with edges of about edge_mm ([Botsch2004]; CGAL's
/// isotropic remeshing in the bounded child), with every point projected onto the input. It is for consumers that need
/// even triangles, such as finite elements; decimation gives a smaller deviation at the same count.
///
/// The result is closed, 2-manifold and free of self-intersections, also in float32 (validity.h). Where it is not, or
/// where it lies further than max_deviation_mm from the input or the input from it (measured at the points and triangle
/// centres of both), the edge length is multiplied by 0.7 and all is done again, four times at most; the report's
/// tries_count says how often. The report also has the final edge_mm, triangles_count, deviation_max_mm,
/// edge_{min,mean,max}_mm, angle_min_deg (the mean of the triangles' smallest angles: 60 is best) and
/// volume_change_percent. The result has the same bytes whatever the thread count.
///
/// Throws Error 65 where the mesh is not finite or its indices are out of range; 80 where it is not valid, or no try
/// was good enough; 70 where the child dies or runs longer than time_limit_s; Cancelled.
Outcome<surface::TriMesh, RemeshResult> remesh(const surface::TriMesh& mesh, const RemeshParams& params,
                                               const Progress& progress = {});

}  // namespace trephine::meshing
