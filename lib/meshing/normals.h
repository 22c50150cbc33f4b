// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

enum class NormalWeight { area, angle };

struct NormalsParams {
  NormalWeight weight = NormalWeight::angle;
  template <class V>
  static void describe(V& v) {
    using P = NormalsParams;
    v.choice(
        &P::weight, "weight", {{"area", NormalWeight::area}, {"angle", NormalWeight::angle}},
        "Weight of a triangle at its point: its area, or its angle there, of which less counts where it is slender.");
  }
};

/// What is printed of normals.
struct NormalsResult {
  std::size_t normals_count = 0;
  std::int64_t normals_replaced_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = NormalsResult;
    v.integer(&P::normals_count, "normals_count", Range{}, "Normals.");
    v.integer(&P::normals_replaced_count, "normals_replaced_count", Range{},
              "Normals that were taken of the largest triangle.");
  }
};

/// Gives each point one unit normal, the weighted mean of its triangles' normals, which faces the way that these do
/// (outwards for a closed surface; by angle as surface::steady_angle says). Points and triangles stay as they are (no
/// vertex is split at an edge), so a closed mesh stays closed; an open mesh is accepted too. Where the mean vanishes,
/// the normal of the largest triangle there is used and counted; a point without triangles gets (0, 0, 1). Throws as
/// check_mesh does.
NormalsResult compute_normals(surface::TriMesh& mesh, const NormalsParams& params, const Progress& progress = {});

}  // namespace trephine::meshing
