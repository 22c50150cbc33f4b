// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace trephine {

/// How much coarser surfaces are drawn on a machine that is too slow for all triangles.
struct Coarseness {
  double within_mm = 0;  ///< how far a vertex may go; 0: nothing is made coarser
  double fine_mm = 30;   ///< around the tool's tip surfaces stay as they are
};

struct CoarseTriangles {
  std::vector<std::uint32_t> indices;  ///< three a triangle, of the same vertices
  std::vector<std::uint32_t> from;     ///< by triangle: the one that it was
};

/// Triangles between fewer of the same vertices, by a grid of cells [Rossignac1993]: all vertices of a cell become the
/// one that lies nearest to their mean, so none goes further than `within_mm`; triangles that lose their area vanish. A
/// closed surface stays closed, vertices at the same place count as one. It may fold over itself and lose thin parts:
/// it is to be looked at, and nothing else.
CoarseTriangles coarse_triangles(const std::vector<SceneVertex>& vertices, const std::vector<std::uint32_t>& indices,
                                 double within_mm);
/// The surface of such triangles, with the vertices that they use.
SceneSurface coarse_surface(const SceneSurface& whole, double within_mm);

}  // namespace trephine
