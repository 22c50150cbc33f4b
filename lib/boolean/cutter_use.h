// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/report.h"
#include "boolean/cutter.h"

namespace trephine {

/// What all do who cut with cutters: surfaces, fields and haptic volumes.

/// Figures are told apart by the cutter's name: one that occurs twice gets a number, a nameless one is "cutter".
std::vector<Cutter> with_unique_names(std::vector<Cutter> cutters);

/// The cutter with its radii grown. A mesh cannot be: throws 78.
Cutter widened(Cutter cutter, double by_mm);

/// What one cutter did, under its name: "burr_hole_1.removed_mm3".
void add_of_cutter(Report& report, const Cutter& cutter, const Report& one);

/// Warns where the cutter is thinner than a voxel: voxels cannot hold it, and what is removed is up to several times
/// its volume.
void warn_of_thin(Report& report, const Cutter& cutter, Vec3 spacing_mm);

}  // namespace trephine
