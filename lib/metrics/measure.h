// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <variant>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "grid/grid.h"
#include "metrics/deviation.h"
#include "surface/trimesh.h"

namespace trephine::metrics {

/// What a surface is measured against. The objects behind the pointers must outlive the call.
struct MeshReference {
  const surface::TriMesh* mesh = nullptr;
};
struct LabelReference {
  const grid::Mask* labels = nullptr;
  int label = 0;  ///< 0: every voxel that is not 0
};
struct TruthReference {
  surface::DistanceFunction distance;
  const surface::TriMesh* mesh = nullptr;  ///< the truth's own surface, fine enough for what is to be measured
  KnownRegion within;                      ///< where distances are taken; volumes are compared all the same
};
using MeasureReference = std::variant<std::monostate, MeshReference, LabelReference, TruthReference>;

struct MeasureParams {
  int sample_count = 100000;  ///< RMS and p99 of a skull come within 1 % of those of four times as many
  bool validity = true;
  template <class V>
  static void describe(V& v) {
    using P = MeasureParams;
    v.integer(&P::sample_count, "sample_count", Range{1000, 100000000},
              "Points on each surface from which RMS, mean, bias and p99 are taken.");
    v.flag(&P::validity, "validity", "Also look for self-intersections and degenerate triangles.");
  }
};

/// What `measure` says of a surface:
///   triangles_count, points_count, components_count, genus_count (-1 where not closed and manifold), closed, manifold,
///   with `validity` also oriented, valid and how many open_edges, nonmanifold_edges, nonmanifold_points,
///   misoriented_edges, duplicate_triangles, self_intersections, degenerate, slivers (meshing/validity.h) there are
///   (..._count), and of each kind that there is the first 20 places, ..._places_mm: x, y, z of one after the other
///   area_mm2, volume_mm3, edge_{min,median,max}_mm, aspect_{median,p99,max}_ratio (metrics/quality.h)
///   reference: none, mesh, labels or truth; and unless none
///   deviation_{max,p99,rms,mean,bias}_mm of both directions together, to_reference_... and from_reference_... of each,
///   samples_count (metrics/deviation.h); reference_volume_mm3, volume_difference_ratio
///   with labels also dice_ratio: of the voxels whose centres lie inside (metrics/overlap.h) with the label
///
/// Against labels the distances are to the surface of the label halfway between its voxels' centres and the others',
/// which lies up to about half a voxel off the shape that was labelled; Dice and volume are of the voxels themselves.
///
/// Throws 65 as check_mesh does, where the surface or the reference has no triangles, or the label no voxels.
Report measure_surface(const surface::TriMesh& mesh, const MeasureReference& reference,
                       const MeasureParams& params = {}, const Progress& progress = {});

}  // namespace trephine::metrics
