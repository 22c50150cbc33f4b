// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Normals of the surfaces of a haptic volume. Nothing here allocates or throws.
#include "contact/felt_lattice.h"

namespace trephine::contact {

/// What ContactVolume::normal_at gives: of the linear function that fits the voxels around best.
Vec3 fitted_normal(const FeltLattice& felt, Vec3 world_mm, int from, int into);

/// What ContactVolume::exact_normal gives: of the sub-voxel surface itself.
Vec3 exact_normal(const FeltLattice& felt, const Contact& contact, Vec3 way);

/// What ContactVolume::normal_of gives: the fitted normal, turned where it would point along the way.
Vec3 normal_of(const FeltLattice& felt, const Contact& contact, Vec3 way);

}  // namespace trephine::contact
