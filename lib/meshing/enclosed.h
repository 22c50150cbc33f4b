// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

/// Removes the components that are oriented inwards (the surfaces of enclosed cavities) and every component that lies
/// within one of them. The mesh must be closed and 2-manifold (one fan at each point), and free of self-intersections
/// except for rounding. Returns how many were removed, and how many pieces are left.
int drop_cavities(surface::TriMesh& mesh, int& pieces_left, const Progress& progress);

}  // namespace trephine::meshing
