// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine::peers {

/// The felt surface of a shape as one mesh: the triangles by which the simulator draws it (drill/live_surface.h), in
/// the world's axes and oriented outwards. Throws Error 65 where the shape has no surface.
surface::TriMesh mesh_of_shape(const voxel::HapticVolume& volume, int shape);

/// The same surface with about so many triangles. More: each triangle is parted in four, without a change of the
/// surface, until there are at least as many. Fewer: edges are collapsed by quadrics (meshoptimizer), which keeps the
/// surface as near as it can and promises nothing. The result may have more triangles than asked, where the surface's
/// topology does not allow as few. Fills the largest distance that meshoptimizer says it went, in mm.
surface::TriMesh with_triangles(const surface::TriMesh& mesh, std::size_t triangles, double* off_mm = nullptr);

}  // namespace trephine::peers
