// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine {

/// Removes the components that look inwards (the surfaces of enclosed cavities) and every component that lies within
/// one of them. The mesh must be closed and 2-manifold (one fan a point), without self-intersections but for rounding.
/// Returns how many went, and how many pieces are left.
int drop_cavities(TriMesh& mesh, int& pieces_left, const Progress& progress);

}  // namespace trephine
