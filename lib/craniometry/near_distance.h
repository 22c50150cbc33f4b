// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "grid/grid.h"

namespace trephine::craniometry {

/// Signed distance in mm to the field's zero crossing (positive inside): the distance to the nearest of its crossings
/// between voxels, up to `reach` voxels, and that limit beyond. The spacing must be the same along all axes. Much
/// faster than signed_distance_mm where only the surroundings of the surface matter.
grid::Grid<float> near_distance_mm(const grid::Field& field, int reach);

}  // namespace trephine::craniometry
