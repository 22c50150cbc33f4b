// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstdint>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "surface/trimesh.h"

namespace trephine::metrics {

struct CertifyParams {
  bool certify = false;
  double certify_tolerance_mm = 0.005;
  std::int64_t certify_max_pieces_count = 100000000;
  template <class V>
  static void describe(V& v) {
    using P = CertifyParams;
    v.flag(&P::certify, "certify", "Against a reference: prove the largest two-sided distance, also between samples.");
    v.number(&P::certify_tolerance_mm, "certify_tolerance_mm", Range{1e-6, 10},
             "Where it certifies: how far the proven bound may lie above a distance that was found.");
    v.integer(&P::certify_max_pieces_count, "certify_max_pieces_count", Range{1000, 1e12},
              "Where it certifies: gives up where a surface would have to be cut into more pieces than this; a million "
              "take a second or two.");
  }
};

/// The Hausdorff distance lies in [lower_mm, upper_mm].
struct CertifiedDistance {
  double lower_mm = 0;  ///< distance of a point that was examined
  double upper_mm = 0;  ///< no point lies further away
  Vec3 at_mm;           ///< world, the point of lower_mm
};

struct CertifiedDeviation {
  CertifiedDistance mesh_to_reference, reference_to_mesh;
  double lower_mm() const { return std::max(mesh_to_reference.lower_mm, reference_to_mesh.lower_mm); }
  double upper_mm() const { return std::max(mesh_to_reference.upper_mm, reference_to_mesh.upper_mm); }
};

/// An upper bound of the distance of every point of either surface to the other, not of samples alone. The distance of
/// a triangle to the surface is at most its distance to one triangle of the surface, which is a convex function and
/// therefore largest at a corner. Where that bound is not good enough the triangle is cut in four (as in [Guthe2005]).
/// It ends when upper - lower <= the tolerance, except where a triangle would need more than 200,000 pieces: there the
/// bound is larger. Throws Error 70 where all triangles of a surface together would need more than the largest count of
/// pieces; this too does not depend on threads or clock. Rounding is on the safe side (1e-9 of the surfaces' size is
/// added). It runs in this process within bounds, with the same bits whatever the thread count. Throws Error 65 as
/// check_mesh does, and for a surface without triangles.
CertifiedDeviation certify_deviation(const surface::TriMesh& mesh, const surface::TriMesh& reference,
                                     const CertifyParams& params, const Progress& progress = {});

/// What is printed of it.
struct CertifiedFigures {
  double max_mm = 0, lower_mm = 0, to_reference_mm = 0, from_reference_mm = 0;
  double at_x_mm = 0, at_y_mm = 0, at_z_mm = 0;
  explicit CertifiedFigures(const CertifiedDeviation& deviation);
  CertifiedFigures() = default;
  template <class V>
  static void describe(V& v) {
    using P = CertifiedFigures;
    v.number(&P::max_mm, "certified_max_mm", Range{}, "No point of either surface lies farther from the other.");
    v.number(&P::lower_mm, "certified_lower_mm", Range{}, "Distance of a point that was examined.");
    v.number(&P::to_reference_mm, "certified_to_reference_mm", Range{}, "The same bound from the mesh alone.");
    v.number(&P::from_reference_mm, "certified_from_reference_mm", Range{}, "And from the reference alone.");
    v.number(&P::at_x_mm, "certified_at_x_mm", Range{}, "Where the examined point lies.");
    v.number(&P::at_y_mm, "certified_at_y_mm", Range{}, "Where the examined point lies.");
    v.number(&P::at_z_mm, "certified_at_z_mm", Range{}, "Where the examined point lies.");
  }
};

}  // namespace trephine::metrics
