// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::segmentation {

/// Distance in mm of each voxel's centre to that of the nearest set voxel, exact (Felzenszwalb and Huttenlocher,
/// "Distance Transforms of Sampled Functions", 2012); 1e6 everywhere where none is set.
Grid<float> distance_mm(const BitMask& to, const Progress& progress = {});

/// Convolves with a Gaussian, cut off at 3 sigma; the edge's values go on outside. In place.
void gaussian(Grid<float>& grid, double sigma_mm, const Progress& progress = {});

/// The Gaussian mean of `values` over the voxels in `known` alone, so that what lies beside (bone, air) does not bleed
/// in; `nowhere` where known voxels carry less than `least_weight` of the kernel. Values of voxels not in `known` are
/// ignored.
Grid<float> masked_gaussian(Grid<float> values, const BitMask& known, double sigma_mm, float nowhere,
                            double least_weight = 0.02, const Progress& progress = {});

/// Seeded watershed: labels `domain` from the seeds (0 = none), the highest voxels first, so that two regions meet
/// where the way between them is lowest: with a distance to the walls as height, in the narrowest place. Face
/// neighbours; levels of 0.05. Domain voxels that no seed reaches stay 0. Seeds outside the domain are ignored.
Mask flood(const Grid<float>& height, const BitMask& domain, const Mask& seeds, const Progress& progress = {});

/// Signed distance in mm to the field's zero crossing (positive inside), from the closest of its sub-voxel surface
/// points, spread by vector sweeps (Danielsson, "Euclidean distance mapping", 1980: exact but for rare voxels, by a
/// small share of a voxel). Beyond a voxel from the surface good to about 0.05 voxel; nearer, too large by up to a
/// quarter of one. 1e6 where there is no surface.
Grid<float> signed_distance_mm(const Field& field, const Progress& progress = {});

/// The middle value of those collected; `otherwise` where there are none. Reorders the values.
float median(std::vector<float>& values, float otherwise);

}  // namespace trephine::segmentation
