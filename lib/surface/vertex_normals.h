// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "surface/trimesh.h"

namespace trephine::surface {

/// A normal for each point, not normalized, from the triangles around it with the weights of [Max1999]. These are exact
/// on a sphere. They need no arc cosine as angle weights do, whose last bit differs between C libraries, so pictures
/// and exported cases are the same everywhere. A normal is zero where no triangle gives it a direction.
/// (meshing/normals.h offers other weights and handles normals that vanish.)
std::vector<Vec3> vertex_normals(const TriMesh& mesh);

}  // namespace trephine::surface
