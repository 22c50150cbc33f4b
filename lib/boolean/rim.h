// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "boolean/corefine.h"

namespace trephine::boolean {

/// Divides the new triangles along the cut's sharp edges, at width_mm from them on both sides, so that one smooth
/// normal for each point shades like a bevel of that width and not across the bore and the triangles around it. The
/// surface stays where it is, within step_mm, the raster of the new points.
void divide_rim(Difference& cut, double step_mm, double width_mm);

}  // namespace trephine::boolean
