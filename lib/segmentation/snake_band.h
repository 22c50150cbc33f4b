// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"

namespace trephine::segmentation {

struct BandParams {
  double propagation = 1, curvature = 0, advection = 0;
  int max_iterations_count = 300;
  double min_change_mm = 0;
  std::size_t max_voxels = ~std::size_t{0};  ///< more inside than this ends the evolution
};

enum class BandEnd { converged, iterations, vanished, filled, too_large };

struct BandRun {
  BandEnd end = BandEnd::iterations;
  int iterations = 0;
  double change_mm = 0;    ///< how far the surface went, on the mean, an iteration, over the last (at most) ten
  double time_step = 0;    ///< of the last step, mm per unit of speed
  double time = 0;         ///< all steps together
  std::size_t inside = 0;  ///< voxels
};

/// Evolves the zero crossing of `phi` (positive inside, any unit on entry) over the speed, in place, at one resolution.
/// On return phi holds mm within two voxels of the surface and plus or minus a constant further away; none is 0.
///
/// A sparse field (Whitaker, "A level-set approach to 3D reconstruction from range data", 1998), with differences to
/// it: the voxels on both sides of the surface are moved by the equation, each with the speed at the surface point
/// next to it, so that the surface comes to rest where the interpolated speed is 0 and phi stays a distance; the two
/// layers beyond are rebuilt by the eikonal equation, in mm. Upwind by Godunov. The step obeys the CFL bound of the
/// propagation and the stability of the curvature.
/// Where there is advection, voxels of speed -1 are walls: they pull nothing, and none moves inside.
///
/// Speed finite, |speed| <= 1, on phi's lattice. The same bits whatever the thread count.
BandRun evolve_band(const grid::Grid<float>& speed, grid::Grid<float>& phi, const BandParams& params,
                    const Progress& progress);

}  // namespace trephine::segmentation
