// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

/// CGAL's isotropic remeshing of a closed 2-manifold in the bounded child. Throws Error 70 where the child dies or runs
/// longer than time_limit_s; Cancelled. Only the indices of the result are checked.
surface::TriMesh remesh_evenly(const surface::TriMesh& mesh, double edge_mm, std::int64_t iterations,
                               double feature_angle_deg, double time_limit_s, const Progress& progress = {});

}  // namespace trephine::meshing
