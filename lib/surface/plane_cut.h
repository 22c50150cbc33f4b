// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "surface/trimesh.h"

namespace trephine::surface {

/// Where a surface meets the plane through that point: a pair of ends (world, mm) for each triangle that it cuts, in
/// the order of the triangles. A point of the surface that lies in the plane counts as above it, so that the lines of a
/// closed surface close. `normal` need not have unit length.
std::vector<std::array<Vec3, 2>> plane_cut(const TriMesh& mesh, Vec3 point_mm, Vec3 normal);

}  // namespace trephine::surface
