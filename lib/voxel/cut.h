// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "surface/distance_function.h"
#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine {

/// Cuts a solid, given by its signed distance (positive outside) and bounds, out of the shapes with these numbers (all
/// where empty): their occupancy is lowered to what the solid leaves, with the same sub-voxel surface as voxelize, and
/// a voxel below the floor of 1/255 becomes EMPTY. What is cut never reads as another shape afterwards, nor does a
/// shape gain anywhere. Encoding `hu`: voxels inside become -1024, those of a window are interpolated towards it where
/// the surface passes between voxel centres. The report: removed_mm3 by shape ("<name>.removed_mm3"), voxels_count
/// changed.
void cut_volume(HapticVolume& volume, const DistanceFunction& solid, const Bounds& solid_bounds_mm,
                const std::vector<int>& shape_numbers, Report& report, const Progress& progress = {});

/// Volume that a shape fills: the sum of its occupancies, two-material shares included, times the voxel's volume.
double shape_volume_mm3(const HapticVolume& volume, int number);

/// The same for fields (positive inside): the field becomes the smaller of itself and the cutter's distance, in the
/// field's own unit near its surface. Positive inside the rest, finite everywhere.
void cut_field(Field& field, const DistanceFunction& solid, const Bounds& solid_bounds_mm, Report& report,
               const Progress& progress = {});

}  // namespace trephine
