// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "base/result.h"
#include "boolean/cutter.h"

namespace trephine::boolean {

/// What all code shares that cuts with cutters: surfaces, fields and haptic volumes.

/// Figures are distinguished by the cutter's name: a name that occurs twice gets a number, and a cutter without a name
/// is "cutter".
std::vector<Cutter> with_unique_names(std::vector<Cutter> cutters);

/// The cutter with larger radii. A mesh cannot be widened: throws Error 78.
Cutter widened(Cutter cutter, double by_mm);

/// What one cutter warns of, with its name before each: "burr_hole_1: removes nothing of skull".
Warnings warnings_of(const Cutter& cutter, const Warnings& of_one);

/// A warning where the cutter is thinner than a voxel: voxels cannot represent it, and up to several times its volume
/// is removed.
std::optional<Warning> thin_cutter(const Cutter& cutter, Vec3 spacing_mm);

}  // namespace trephine::boolean
