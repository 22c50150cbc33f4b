// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "stages/stage.h"

namespace trephine {

/// Cuts solids, made wider by widen_mm all around, out of a surface. Ports: surface, and "cutters.*".
StageType boolean_stage(double widen_mm = 0);

/// Figures are told apart by the cutter's name: one that occurs twice gets a number, a nameless one is "cutter".
std::vector<Cutter> with_unique_names(std::vector<Cutter> cutters);

/// What one cutter did, under its name.
void add_of_cutter(Report& report, const Cutter& cutter, const Report& one);

/// The cutter with its radii grown. A mesh cannot be: throws 78.
Cutter widened(Cutter cutter, double by_mm);

/// Warns where the cutter is thinner than a voxel: voxels cannot hold it, and what is removed is up to several times
/// its volume.
void warn_of_thin(Report& report, const Cutter& cutter, Vec3 spacing_mm);

/// The cutters of the ports "cutters.*", in the order of the ports' names; a name that occurs twice gets a number.
std::vector<Cutter> cutters_of(const StageInputs& inputs);

}  // namespace trephine
