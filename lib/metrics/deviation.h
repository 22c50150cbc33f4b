// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "surface/distance_function.h"
#include "surface/trimesh.h"

namespace trephine::metrics {

struct DeviationParams {
  int sample_count = 200000;
  bool at_vertices = true;  ///< not a user's parameter: whether max_mm also includes every vertex
  template <class V>
  static void describe(V& v) {
    v.integer(&DeviationParams::sample_count, "sample_count", Range{1000, 100000000},
              "Points on each surface from which RMS, mean, bias and p99 are computed.");
  }
};

/// Distances of one surface to another. RMS, mean, bias and p99 are taken over points spread evenly over the area (each
/// stands for the same area, so that dense triangles do not count more); max also includes every vertex. p99 is the
/// nearest rank: the smallest distance that at least 99 % of the points do not exceed.
struct DeviationStats {
  double max_mm = 0, p99_mm = 0, rms_mm = 0, mean_mm = 0;
  /// Mean of the signed distances, positive where the mesh lies outside of the reference, in either direction of
  /// measuring.
  double bias_mm = 0;
  std::size_t samples = 0;
  template <class V>
  static void describe(V& v) {  // as figures of a report (base/result.h)
    using P = DeviationStats;
    v.number(&P::max_mm, "max_mm", Range{}, "Largest distance.");
    v.number(&P::p99_mm, "p99_mm", Range{}, "99th percentile of the distances.");
    v.number(&P::rms_mm, "rms_mm", Range{}, "Root mean square of the distances.");
    v.number(&P::mean_mm, "mean_mm", Range{}, "Mean of the distances.");
    v.number(&P::bias_mm, "bias_mm", Range{}, "Mean of the signed distances.");
  }
};

struct Deviation {
  DeviationStats mesh_to_reference, reference_to_mesh;
  DeviationStats both;            ///< of the points of both sides together
  std::size_t samples_count = 0;  ///< of both sides
  template <class V>
  static void describe(V& v) {
    using P = Deviation;
    v.all_of(&P::both, "deviation_");
    v.all_of(&P::mesh_to_reference, "to_reference_");
    v.all_of(&P::reference_to_mesh, "from_reference_");
    v.integer(&P::samples_count, "samples_count", Range{}, "Points on both surfaces.");
  }
};

/// The region in which the truth is known; null: everywhere. Called from several threads.
using KnownRegion = std::function<bool(Vec3 world_mm)>;

/// Two-sided deviation. The points are the same whatever the thread count, platform or order of calls: the area is cut,
/// in the order of the triangles, into sample_count equal pieces, with one point in each, placed by a hash of its
/// number. The bias needs closed, oriented surfaces. Throws 65 as check_mesh does, and for a surface without triangles
/// or area.
Deviation measure_deviation(const surface::TriMesh& mesh, const surface::TriMesh& reference,
                            const DeviationParams& params = {}, const Progress& progress = {});

/// The same against a known surface: from the mesh by the distance function of the truth (every sample and every
/// vertex), from the truth's own mesh to the mesh by nearest points. Parts of the truth that its mesh leaves out are
/// not noticed in the second direction. Points of either surface outside `within` are left out (a scan that ends in the
/// middle of a head has caps without a truth); throws Error 65 where that leaves none.
Deviation measure_deviation_to_truth(const surface::TriMesh& mesh, const surface::DistanceFunction& truth,
                                     const surface::TriMesh& truth_mesh, const DeviationParams& params = {},
                                     const KnownRegion& within = {}, const Progress& progress = {});

/// The points described above, world; none where `count` is 0.
std::vector<Vec3> points_on_surface(const surface::TriMesh& mesh, std::size_t count);

}  // namespace trephine::metrics
