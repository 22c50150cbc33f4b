// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "surface/trimesh.h"

namespace trephine {

/// The volume that two closed, outwards oriented meshes share, in closed form and without computing their intersection:
/// along every line parallel to `direction` a solid is the signed sum of the half-lines beneath its triangles, so the
/// shared length is the sum over pairs of triangles, one of each, of the lower one's height, integrated where the
/// pair's shadows overlap (linear pieces). Exact but for rounding, about 1e-12 of the smaller one's volume. Fastest
/// where b is the smaller one, and has many facets parallel to `direction`.
double overlap_mm3(const TriMesh& a, const TriMesh& b, Vec3 direction);

}  // namespace trephine
