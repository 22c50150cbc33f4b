// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "boolean/cutter.h"
#include "cases/case.h"
#include "config/config.h"
#include "voxel/haptic_volume.h"
#include "voxel/mismatch.h"

namespace trephine::publish {

/// The haptic part of a case.
struct HapticContent {
  cases::CaseHaptic manifest;                 ///< without the files' names
  std::vector<cases::CaseAnatomy> anatomies;  ///< for shapes that have no surface of their own
  std::string bytes, hardness_bytes;
};

/// `made` is the result of voxelize, `mismatch` that of mismatch.
HapticContent make_haptic_content(const config::CaseConfig& config, const voxel::HapticVolume& volume,
                                  const voxel::VoxelizeResult& made, const voxel::MismatchResult& mismatch);

}  // namespace trephine::publish
