// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "surface/trimesh.h"

namespace trephine {

/// A normal for each point, not normalized, from the triangles around it with the weights of N. Max, "Weights for
/// computing vertex normals from facet normals" (1999): exact on a sphere, and without the arc cosine of angle weights,
/// whose last bit differs between C libraries, so that pictures and exported cases are the same everywhere. Zero where
/// no triangle says anything. (meshing/normals.h offers other weights and sees to normals that vanish.)
std::vector<Vec3> vertex_normals(const TriMesh& mesh);

}  // namespace trephine
