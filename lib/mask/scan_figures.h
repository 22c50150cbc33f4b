// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "base/params.h"
#include "base/progress.h"
#include "grid/grid.h"

namespace trephine::mask {

/// What a scan is like, measured on its voxels alone. Noise is measured in tiles of 6 mm of even soft tissue, where
/// there is a skull in those that have bone on all four sides in their slice.
struct ScanFigures {
  double pixel_mm = 0, slice_step_mm = 0;  ///< distances of voxels in and across the slices
  std::int64_t tiles_count = 0;            ///< tiles that noise was measured in; below 40 the noise is not known
  double noise_hu = 0;                     ///< standard deviation of a voxel, whatever the noise's colour
  double cube_noise_hu = 0;                ///< that of the mean over 8 mm^3: what is left for a shape of 2 mm
  double neighbour_correlation_ratio = 0;  ///< of a voxel's noise with that of the next in its row or column
  double slice_correlation_ratio = 0;      ///< with that of the next slice: slices thicker than their distance share it
  double kernel_mm = 0;                    ///< full width at half maximum of the Gaussian kernel with that correlation;
                                           ///< 0 where the kernel enhances edges, so that neighbours hardly go together
  double edge_mm = 0;                      ///< the same from the sharpest fifth of the edges between air and skin;
                                           ///< 0: too few were seen
  double artefact_ratio = 0;               ///< share of the tiles that are far more uneven than noise and brain are

  template <class V>
  static void describe(V& v) {
    using P = ScanFigures;
    v.number(&P::pixel_mm, "pixel_mm", Range{}, "Distance of voxels in a slice.");
    v.number(&P::slice_step_mm, "slice_step_mm", Range{}, "Distance of slices.");
    v.integer(&P::tiles_count, "tiles_count", Range{}, "Tiles of even soft tissue that noise was measured in.");
    v.number(&P::noise_hu, "noise_hu", Range{}, "Standard deviation of a voxel.");
    v.number(&P::cube_noise_hu, "cube_noise_hu", Range{}, "Standard deviation of the mean over a cube of 2 mm.");
    v.number(&P::neighbour_correlation_ratio, "neighbour_correlation_ratio", Range{}, "Of noise in the slice.");
    v.number(&P::slice_correlation_ratio, "slice_correlation_ratio", Range{}, "Of noise across slices.");
    v.number(&P::kernel_mm, "kernel_mm", Range{}, "Width of the kernel as noise shows it; 0: it enhances edges.");
    v.number(&P::edge_mm, "edge_mm", Range{}, "Width of the kernel as the skin's edge shows it; 0: not seen.");
    v.number(&P::artefact_ratio, "artefact_ratio", Range{}, "Share of tiles with streaks or the like.");
  }
  bool known() const { return tiles_count >= 40; }
};

/// Takes about 10 ns a voxel. The slices are those across the axis of the largest spacing, the last one where all are
/// alike. The same figures whatever the thread count.
ScanFigures measure_scan(const grid::HuVolume& volume, const Progress& progress = {});

}  // namespace trephine::mask
