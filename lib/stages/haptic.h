// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "stages/stage.h"
#include "voxel/voxelize.h"

namespace trephine {

/// What a scene says of one shape of its haptic volume, besides the numbers of VoxelizeParams.
struct HapticShapeSpec {
  std::string name;
  std::string clear_of;  ///< another shape: nothing of this one within clear_mm of its surface
  double clear_mm = 0;
  std::int16_t low_hu = 0, high_hu = 0;  ///< encoding hu: its window
  bool drilled = false;                  ///< burr holes are cut from it ...
  double widen_mm = 0;                   ///< ... so much wider all around
};

struct HapticSpec {
  HapticEncoding encoding = HapticEncoding::occupancy;
  std::string region_of;                ///< shape or other surface whose box is the region; empty: all shapes'
  std::vector<HapticShapeSpec> shapes;  ///< precedence: the first first
};

/// The spec as text: part of a cache's key.
std::string to_text(const HapticSpec& spec);

/// Makes the haptic volume and cuts it. Ports: volume (the scan: its axes, HU and hardness), "shape.<name>" for each
/// shape of encoding occupancy, "region" where region_of is no shape, "clear.<name>" where clear_of is no shape, and
/// "cutters.*". The report: what voxelize says, then "<cutter>.<shape>.removed_mm3". Parameters: VoxelizeParams.
StageType voxelize_stage(const HapticSpec& spec);

/// How far what is felt lies from what is seen. Ports: haptic, "surface.<shape>". The report:
/// "<shape>.mismatch_{bias,rms,p99,max}_mm", "<shape>.mismatch_missed_ratio", "<shape>.mismatch_samples_count".
StageType mismatch_stage();

}  // namespace trephine
