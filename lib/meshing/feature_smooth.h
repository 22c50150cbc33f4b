// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

/// Where the points of a closed surface would lie if its triangles faced the way that their neighbours do, while edges
/// sharper than about feature_angle_deg are kept. The normals are filtered bilaterally over the triangles that share a
/// point [Zheng2011], `iterations` times or until they no longer change; then points are fitted to the normals
/// [Sun2007]. The result has the same bits whatever the thread count.
std::vector<Vec3> fit_to_filtered_normals(const surface::TriMesh& mesh, std::int64_t iterations,
                                          double feature_angle_deg, const Progress& progress);

}  // namespace trephine::meshing
