// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "mask/hu_view.h"

namespace trephine::segmentation {

/// The last steps for the field of an anatomy, however it was found.
struct FinishParams {
  double grow_mm = 0;  ///< moves the surface outwards by this; the field is then in mm
  double max_scan_edge_ratio =
      1;  ///< largest share of the rim in the slices that may be the edge of the scanned field; 1: any
};

/// Throws Error 64 where the lower one is above the upper one.
void check_thresholds(double lower_hu, double upper_hu);

/// Runs `find` on the volume, moves the surface, and crops the field to its positive part and a margin of two voxels.
/// Adds "voxels_count", "volume_ml", and where they are requested "grown_mm" and "scan_edge_ratio". Throws Error 65
/// where a voxel is not finite; 80 where the mask is empty, fills the volume or lies in one slice, or where more of its
/// rim than allowed is the edge of the scan. A fault that names no parameter is attributed to lower_hu and upper_hu.
grid::Field found_and_finished(const grid::HuVolume& volume, const FinishParams& params,
                               const std::function<grid::Field(const mask::HuView&)>& find, Report& report,
                               const Progress& progress);

}  // namespace trephine::segmentation
