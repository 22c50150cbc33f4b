// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <variant>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
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
    v.integer(
        &P::sample_count, "sample_count", Range{1000, 100000000},
        "Points on each surface, at most, from which RMS, mean, bias and p99 are taken: one a mm^2, and 10,000 of a "
        "small one.");
    v.flag(&P::validity, "validity", "Also look for self-intersections and degenerate triangles.");
  }
};

enum class ReferenceKind { none, mesh, labels, truth };

/// How many faults of a kind there are, and where the first 20 lie: x, y, z of one after the other.
struct FaultsOfAKind {
  std::size_t count = 0;
  std::vector<double> places_mm;
  template <class V>
  static void describe(V& v) {
    v.integer(&FaultsOfAKind::count, "count", Range{}, "How many there are.");
    v.numbers(&FaultsOfAKind::places_mm, "places_mm", "Where the first of them lie.");
  }
};

/// Of the check of validity (meshing/validity.h).
struct ValidityFigures {
  bool oriented = false, valid = false;
  FaultsOfAKind open_edges, nonmanifold_edges, nonmanifold_points, misoriented_edges, duplicate_triangles,
      self_intersections, degenerate, slivers;
  template <class V>
  static void describe(V& v) {
    using P = ValidityFigures;
    v.flag(&P::oriented, "oriented", "Whether all triangles face outwards.");
    v.flag(&P::valid, "valid", "Whether the surface is valid.");
    v.all_of(&P::open_edges, "open_edges_");
    v.all_of(&P::nonmanifold_edges, "nonmanifold_edges_");
    v.all_of(&P::nonmanifold_points, "nonmanifold_points_");
    v.all_of(&P::misoriented_edges, "misoriented_edges_");
    v.all_of(&P::duplicate_triangles, "duplicate_triangles_");
    v.all_of(&P::self_intersections, "self_intersections_");
    v.all_of(&P::degenerate, "degenerate_");
    v.all_of(&P::slivers, "slivers_");
  }
};

/// What `measure` says of a surface. Parts that were not asked for, or cannot be measured, are missing.
struct MeasureResult {
  std::size_t triangles_count = 0, points_count = 0, components_count = 0;
  std::int64_t genus_count = 0;  ///< -1 where not closed and manifold
  bool closed = false, manifold = false;
  std::optional<ValidityFigures> validity;
  double area_mm2 = 0, volume_mm3 = 0, edge_min_mm = 0, edge_median_mm = 0, edge_max_mm = 0;
  double aspect_median_ratio = 0, aspect_p99_ratio = 0, aspect_max_ratio = 0;  ///< metrics/quality.h
  ReferenceKind reference = ReferenceKind::none;
  std::optional<Deviation> deviation;
  std::optional<double> reference_volume_mm3, volume_difference_ratio;
  std::optional<double> dice_ratio;  ///< against labels: of the voxels whose centres lie inside (metrics/overlap.h)
  template <class V>
  static void describe(V& v) {
    using P = MeasureResult;
    v.integer(&P::triangles_count, "triangles_count", Range{}, "Triangles.");
    v.integer(&P::points_count, "points_count", Range{}, "Points.");
    v.integer(&P::components_count, "components_count", Range{}, "Connected components.");
    v.integer(&P::genus_count, "genus_count", Range{}, "Genus; -1: not closed and manifold.");
    v.flag(&P::closed, "closed", "Whether it is closed.");
    v.flag(&P::manifold, "manifold", "Whether it is 2-manifold.");
    v.all_of(&P::validity);
    v.number(&P::area_mm2, "area_mm2", Range{}, "Area.");
    v.number(&P::volume_mm3, "volume_mm3", Range{}, "Volume.");
    v.number(&P::edge_min_mm, "edge_min_mm", Range{}, "Shortest edge.");
    v.number(&P::edge_median_mm, "edge_median_mm", Range{}, "Median edge.");
    v.number(&P::edge_max_mm, "edge_max_mm", Range{}, "Longest edge.");
    v.number(&P::aspect_median_ratio, "aspect_median_ratio", Range{}, "Median aspect ratio of the triangles.");
    v.number(&P::aspect_p99_ratio, "aspect_p99_ratio", Range{}, "99th percentile of it.");
    v.number(&P::aspect_max_ratio, "aspect_max_ratio", Range{}, "Largest of it.");
    v.choice(&P::reference, "reference",
             {{"none", ReferenceKind::none},
              {"mesh", ReferenceKind::mesh},
              {"labels", ReferenceKind::labels},
              {"truth", ReferenceKind::truth}},
             "What it was measured against.");
    v.all_of(&P::deviation);
    v.number(&P::reference_volume_mm3, "reference_volume_mm3", "Volume of the reference.");
    v.number(&P::volume_difference_ratio, "volume_difference_ratio", "Difference of volume, as a share of that.");
    v.number(&P::dice_ratio, "dice_ratio", "Dice coefficient with the labels.");
  }
};

/// Measures it. Against labels the distances are to the surface of the label halfway between its voxels' centres and
/// the others', which lies up to about half a voxel off the shape that was labelled; Dice and volume are of the voxels
/// themselves.
///
/// Throws 65 as check_mesh does, where the surface or the reference has no triangles, or the label no voxels.
Outcome<std::monostate, MeasureResult> measure_surface(const surface::TriMesh& mesh, const MeasureReference& reference,
                                                       const MeasureParams& params = {}, const Progress& progress = {});

}  // namespace trephine::metrics
