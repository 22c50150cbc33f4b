// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "surface/trimesh.h"

namespace trephine::boolean {

/// The volume that two closed meshes oriented outwards share, in closed form and without computing their intersection.
/// Along every line parallel to `direction` a solid is the signed sum of the half-lines beneath its triangles. The
/// shared length is therefore a sum over pairs of triangles, one of each mesh, of the height of the lower one,
/// integrated where the shadows of the pair overlap (linear pieces). Exact except for rounding, about 1e-12 of the
/// smaller volume. Fastest where b is the smaller mesh and has many facets parallel to `direction`.
double overlap_mm3(const surface::TriMesh& a, const surface::TriMesh& b, Vec3 direction);

}  // namespace trephine::boolean
