// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine {

/// CGAL's isotropic remeshing in the bounded child, of a closed 2-manifold. Throws Error 70 where the child dies or
/// runs longer than time_limit_s; Cancelled. The result is not checked but for its indices.
TriMesh remesh_evenly(const TriMesh& mesh, double edge_mm, std::int64_t iterations, double feature_angle_deg,
                      double time_limit_s, const Progress& progress = {});

}  // namespace trephine
