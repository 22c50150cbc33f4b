// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"

namespace trephine::grid {

struct ResampleParams {
  std::array<double, 3> spacing_mm{0, 0, 0};
  template <class V>
  static void describe(V& v) {
    v.numbers(&ResampleParams::spacing_mm, "spacing_mm", Range{0, 50},
              "Voxel size along the scan's own axes; 0 keeps the scanned size along that axis.");
  }
};

struct ResampleResult {
  std::array<double, 3> spacing_mm{0, 0, 0};  ///< as it came out
  double coarsest_ratio = 1;                  ///< the largest of what a voxel grew by along an axis
  std::size_t voxels_count = 0;
  double voxels_ratio = 1;  ///< to those of before
  template <class V>
  static void describe(V& v) {
    using P = ResampleResult;
    v.numbers(&P::spacing_mm, "spacing_mm", Range{}, "Voxel size along the axes.");
    v.number(&P::coarsest_ratio, "coarsest_ratio", Range{}, "The largest of what a voxel grew by along an axis.");
    v.integer(&P::voxels_count, "voxels_count", Range{}, "Count of voxels.");
    v.number(&P::voxels_ratio, "voxels_ratio", Range{}, "The same as a share of the count before.");
  }
};

/// Resamples a volume to another spacing. The new raster has the same direction and the same centre, and along each
/// axis as many voxels as fill the old extent best (at least one). A value is the mean of the old voxels that the new
/// one overlaps, weighted by their shares (partial volume, as a scanner with such voxels would measure it); where the
/// new voxel is smaller than the old one it is the linear interpolation. Beyond the ends the outermost voxel continues.
/// Integer volumes are rounded (half away from 0). Throws Error 64 where the spacing is negative or not finite, 65
/// where a voxel is not finite, 80 where the new volume would have more than 4e9 voxels.
Outcome<HuVolume, ResampleResult> resample(const HuVolume& volume, const ResampleParams& params,
                                           const Progress& progress = {});

/// The same of a grid, on steps above 0 that are all finite: nothing is checked, nothing reported.
template <class T>
Grid<T> resampled_grid(const Grid<T>& in, const std::array<double, 3>& step_mm, const Progress& progress = {});
extern template Grid<std::int16_t> resampled_grid(const Grid<std::int16_t>&, const std::array<double, 3>&,
                                                  const Progress&);
extern template Grid<float> resampled_grid(const Grid<float>&, const std::array<double, 3>&, const Progress&);

}  // namespace trephine::grid
