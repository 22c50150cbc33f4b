// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/error.h"
#include "base/parameter.h"
#include "boolean/cutter.h"
#include "cases/case.h"
#include "config/config.h"
#include "voxel/haptic_volume.h"
#include "voxel/mismatch.h"

namespace trephine::publish {

/// What a stage's result says of one of its cutters or shapes. Throws Error 70 where it says nothing.
template <class T>
const T& part_of(const Named<T>& all, const std::string& name) {
  if (const T* one = find_item(all, name)) return *one;
  throw Error(ExitCode::internal, "", name, "a stage's result lacks this part");
}

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
