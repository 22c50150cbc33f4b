// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The surfaces near a place as samples, for tools that are round and not points. Nothing here allocates or throws.
#include "contact/felt_lattice.h"

namespace trephine::contact {

/// What ContactVolume::samples_near gives.
int samples_near(const FeltLattice& felt, Vec3 from_mm, Vec3 to_mm, double reach_mm, SurfaceSample* out, int most);

}  // namespace trephine::contact
