// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <vector>

#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::mask {

/// Exact distance in mm from each voxel's centre to the centre of the nearest set voxel [Felzenszwalb2012]; 1e6
/// everywhere where no voxel is set.
grid::Grid<float> distance_mm(const BitMask& to, const Progress& progress = {});

/// Convolves with a Gaussian, cut off at 3 sigma, in place. Outside of the grid the values of its edge continue.
void gaussian(grid::Grid<float>& grid, double sigma_mm, const Progress& progress = {});

/// The Gaussian mean of `values` over the voxels in `known` alone, so that neighbouring bone or air does not bleed in;
/// `nowhere` where known voxels carry less than `min_weight` of the kernel. Values of voxels not in `known` are
/// ignored.
grid::Grid<float> masked_gaussian(grid::Grid<float> values, const BitMask& known, double sigma_mm, float nowhere,
                                  double min_weight = 0.02, const Progress& progress = {});

/// Seeded watershed: labels `domain` from the seeds (0 = none), the highest voxels first, so that two regions meet
/// where the passage between them is lowest. With the distance to the walls as height, that is the narrowest place.
/// Uses face neighbours and levels of 0.05. Domain voxels that no seed reaches stay 0. Seeds outside the domain are
/// ignored.
grid::Mask flood(const grid::Grid<float>& height, const BitMask& domain, const grid::Mask& seeds,
                 const Progress& progress = {});

/// Signed distance in mm to the field's zero crossing (positive inside). It is the distance to the closest of the
/// surface points between voxels, spread by vector sweeps ([Danielsson1980]: exact except for rare voxels, which are
/// off by a small share of a voxel). More than a voxel from the surface it is good to about 0.05 voxel; nearer, it is
/// too large by up to a quarter of a voxel. 1e6 where there is no surface.
grid::Grid<float> signed_distance_mm(const grid::Field& field, const Progress& progress = {});

/// 0 at `zero`, 1 at `one`, linear between them; `one` may be the smaller.
inline double ramp(double value, double zero, double one) {
  return std::clamp((value - zero) / (one - zero), 0.0, 1.0);
}

/// Throws Error 65, naming the voxel, where one is not finite.
void check_finite(const grid::Field& field);

/// The median of the values; `otherwise` where there are none. Reorders the values.
float median(std::vector<float>& values, float otherwise);

}  // namespace trephine::mask
