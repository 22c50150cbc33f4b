// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine {

/// What was done to a soup, for the report.
struct SoupCounts {
  std::size_t merged = 0, sideless = 0, duplicates = 0, fins = 0, sheets = 0, flipped = 0, split = 0;
};

/// Makes an oriented 2-manifold, maybe with borders, out of any triangles (finite points, indices in range), moving no
/// point further than merge_mm; in this order:
///  - points that are equal become one; then those at open edges within merge_mm of each other;
///  - triangles with a repeated point go; of triangles of the same three points one stays, or none where their edges
///    hold together without them (a wall between two pieces);
///  - a triangle with a free edge and an edge of three or more triangles goes (a fin);
///  - each patch within edges of two triangles is turned one way, the one that most of its area has;
///  - at edges of four or more triangles those that bound the same wedge of the solid are joined, where they alternate;
///  - points of several fans are taken apart, and moved inwards by a few steps where they are not at a border;
///  - open pieces that enclose nothing (flat sheets) go, and closed ones that lie in no other are turned outwards.
void clean_soup(TriMesh& mesh, double merge_mm, SoupCounts& counts, const Progress& progress = {});

}  // namespace trephine
