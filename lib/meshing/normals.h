// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

enum class NormalWeight { area, angle };

struct NormalsParams {
  NormalWeight weight = NormalWeight::angle;
  template <class V>
  static void describe(V& v) {
    using P = NormalsParams;
    v.choice(&P::weight, "weight", {{"area", NormalWeight::area}, {"angle", NormalWeight::angle}},
             "Weight of a triangle at its point: its area, or its angle there.");
  }
};

/// Gives each point one unit normal, the weighted mean of its triangles' normals, which faces the way that these do
/// (outwards for a closed surface). Points and triangles stay as they are (no vertex is split at an edge), so a closed
/// mesh stays closed; an open mesh is accepted too. Where the mean vanishes, the normal of the largest triangle there
/// is used and counted; a point without triangles gets (0, 0, 1). Throws as check_mesh does.
void compute_normals(surface::TriMesh& mesh, const NormalsParams& params, Report& report,
                     const Progress& progress = {});

}  // namespace trephine::meshing
