// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/report.h"
#include "boolean/cutter.h"

namespace trephine::boolean {

/// What all code shares that cuts with cutters: surfaces, fields and haptic volumes.

/// Figures are distinguished by the cutter's name: a name that occurs twice gets a number, and a cutter without a name
/// is "cutter".
std::vector<Cutter> with_unique_names(std::vector<Cutter> cutters);

/// The cutter with larger radii. A mesh cannot be widened: throws Error 78.
Cutter widened(Cutter cutter, double by_mm);

/// Adds what one cutter did, under its name: "burr_hole_1.removed_mm3".
void add_of_cutter(Report& report, const Cutter& cutter, const Report& one);

/// Warns where the cutter is thinner than a voxel: voxels cannot represent it, and up to several times its volume is
/// removed.
void warn_of_thin(Report& report, const Cutter& cutter, Vec3 spacing_mm);

}  // namespace trephine::boolean
