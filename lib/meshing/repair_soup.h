// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

/// What was done to a soup, for the report.
struct SoupCounts {
  std::size_t merged = 0, sideless = 0, duplicates = 0, fins = 0, sheets = 0, flipped = 0, split = 0;
};

/// Makes an oriented 2-manifold, perhaps with borders, out of any triangles (finite points, indices in range). No point
/// moves further than merge_mm. The steps, in this order:
/// - Equal points are merged; then points at open edges within merge_mm of each other.
/// - Triangles with a repeated point are removed. Of several triangles with the same three points one stays, or none
///   where their edges hold together without them (a wall between two pieces).
/// - A triangle with a free edge and an edge shared by three or more triangles is removed (a fin).
/// - Each patch bounded by edges that are not shared by exactly two triangles is turned to one side, the one that most
///   of its area has.
/// - At edges of four or more triangles, those that bound the same wedge of the solid are joined, where they alternate.
/// - Points with several fans are split, and moved inwards by a few steps where they are not at a border.
/// - Open pieces that enclose nothing (flat sheets) are removed, and closed pieces that lie in no other are oriented
///   outwards.
void clean_soup(surface::TriMesh& mesh, double merge_mm, SoupCounts& counts, const Progress& progress = {});

}  // namespace trephine::meshing
