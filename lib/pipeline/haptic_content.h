// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "boolean/cutter.h"
#include "cases/case.h"
#include "pipeline/config.h"
#include "voxel/haptic_volume.h"

namespace trephine {

/// The haptic part of a case.
struct HapticContent {
  CaseHaptic manifest;                 ///< without the files' names
  std::vector<CaseAnatomy> anatomies;  ///< of shapes that have no surface of their own
  std::string bytes, hardness_bytes;
};

/// `made` is the report of voxelize, `mismatch` that of mismatch.
HapticContent make_haptic_content(const CaseConfig& config, const HapticVolume& volume, const Report& made,
                                  const Report& mismatch);

/// How much thinner than the hole is what must pass it.
constexpr double hole_play_mm = 0.5;

/// Nothing of the shape is felt within the cylinder, less the play.
bool hole_is_free(const HapticVolume& volume, const std::string& shape, const Cutter& cylinder);

/// The surface at which a shape's trilinear occupancy is 1/2, capped where the volume ends.
TriMesh surface_of_shape(const HapticVolume& volume, int number, const Progress& progress = {});

}  // namespace trephine
