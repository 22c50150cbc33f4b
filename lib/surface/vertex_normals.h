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

/// The angle between two edges of a triangle, radians, as far as its normal can be relied on: with height h over its
/// longest edge it counts by h^2 / (h^2 + (0.2 mm)^2). Points that are off by so much turn a lower triangle anywhere,
/// and at an obtuse corner the whole angle would give it half of all weights.
double steady_angle(Vec3 a, Vec3 b);

}  // namespace trephine::surface
