// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>

#include "base/params.h"
#include "grid/grid.h"
#include "voxel/haptic_volume.h"

namespace trephine::drill {

/// The law of removal.
struct DrillParams {
  double power_w = 20, max_rate_per_s = 400, soft_energy_ratio = 0.3;
  template <class V>
  static void describe(V& v) {
    using P = DrillParams;
    v.number(&P::power_w, "power_w", Range{0.01, 1000}, "Power of the drill's spindle under load.");
    v.number(&P::max_rate_per_s, "max_rate_per_s", Range{0.01, 10000},
             "Largest rate at which occupancy falls in the cutter's middle; 400: a full voxel in 2.5 ms.");
    v.number(&P::soft_energy_ratio, "soft_energy_ratio", Range{0.001, 1},
             "Energy for the softest material of a hardness volume, as a share of its shape's.");
  }
};

/// How a shape is removed. Energy 0: never by a rotating tool, however cuttable it is.
struct DrillShape {
  bool cuttable = false;
  double energy_j_per_mm3 = 0;
};
using DrillShapes = std::array<DrillShape, voxel::haptic_max_shapes + 1>;

/// What one call removed. A voxel counts by its occupancy.
struct Removal {
  std::array<std::int64_t, voxel::haptic_max_shapes + 1> units{};  ///< by shape; 255 are a voxel
  double energy_j = 0;
  double power_w = 0;           ///< over the call's time
  std::int64_t late_units = 0;  ///< of all units, those where the tool is a voxel further on already (cut_way)
  grid::Box changed;            ///< voxels that may have another value than before; empty where there are none
};

}  // namespace trephine::drill
