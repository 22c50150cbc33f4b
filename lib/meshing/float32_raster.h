// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "surface/trimesh.h"

namespace trephine::meshing {

/// Whether snap_to_float32 (validity.h) would leave the mesh as it is.
bool on_float32_raster(const surface::TriMesh& mesh);

}  // namespace trephine::meshing
