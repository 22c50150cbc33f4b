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
/// a voxel below the floor of 1/255 becomes EMPTY.
///
/// No shape's occupancy rises in any voxel, so nowhere under trilinear interpolation; what is cut never reads as
/// another shape. A voxel of two shapes keeps the larger share where the other one's cannot be kept beside it. Voxels
/// beside the cut whose rest would go to another shape than before become bare.
///
/// Encoding `hu`: voxels of the windows within the solid become -1024 (all voxels, where all shapes are cut). Where no
/// voxel of another window is near, those on the ramp get HU that put the surface where the solid's is (for windows
/// above the lowest it may lie up to (low - lowest low) / (low + 1024) of a voxel farther from the solid), never a
/// value of another window. No voxel reads as a shape that it was not.
///
/// The report: "<name>.removed_mm3" (by shape_volume_mm3) of the shapes cut, voxels_count changed; a warning where
/// nothing of any of them is removed.
void cut_volume(HapticVolume& volume, const DistanceFunction& solid, const Bounds& solid_bounds_mm,
                const std::vector<int>& shape_numbers, Report& report, const Progress& progress = {});

/// Volume that a shape fills, two-material shares included. A voxel counts by its occupancy o as
/// clamp(1/2 + 2 (o - 1/2), 0, 1): the ramp of occupancy is twice as wide as a voxel's share of a plane, and without
/// that a ball of radius R voxels would measure (ramp / R)^2 too large. Encoding `hu`: the voxels in its window.
double shape_volume_mm3(const HapticVolume& volume, int number);

/// The same for fields (positive inside): the field becomes the smaller of itself and the cutter's distance, in the
/// field's own unit near its surface (the median length of its gradient there), as far as three voxels from the solid.
/// Positive inside the rest, finite everywhere. The report: voxels_count changed, unit_per_mm; a warning where no voxel
/// inside is lowered.
void cut_field(Field& field, const DistanceFunction& solid, const Bounds& solid_bounds_mm, Report& report,
               const Progress& progress = {});

}  // namespace trephine
