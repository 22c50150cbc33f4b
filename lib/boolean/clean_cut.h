// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "boolean/corefine.h"

namespace trephine::boolean {

/// Puts the new points of a cut on the raster of step_mm, and removes details that are too fine for it. A new point
/// nearer than shortest_mm to a neighbour is merged into it (where the surface stays a 2-manifold and no triangle turns
/// over), and the long edge of a triangle lower than flattest_mm is flipped. No point moves further than shortest_mm
/// plus the step. Triangles that are not at a new point or beside a flat triangle stay as they were, and old points
/// never move. The result may still intersect itself.
void clean_cut(Difference& cut, double step_mm, double shortest_mm, double flattest_mm);

}  // namespace trephine::boolean
