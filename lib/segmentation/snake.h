// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "grid/grid.h"

namespace trephine {

enum class SnakeMethod { region_competition, geodesic };

struct SnakeParams {
  SnakeMethod method = SnakeMethod::region_competition;
  double propagation = 1.0, curvature = 0.2, advection = 0;
  int max_iterations_count = 300;
  double min_change_mm = 0.002;
  int coarse_levels_count = 1;
  double min_mean_speed = -1;

  template <class V>
  static void describe(V& v) {
    using P = SnakeParams;
    v.choice(&P::method, "method",
             {{"region_competition", SnakeMethod::region_competition}, {"geodesic", SnakeMethod::geodesic}},
             "What drives the surface: the speed's sign, outwards where it is positive and inwards where negative; or "
             "outwards up to image edges, where the speed is near 0.");
    v.number(&P::propagation, "propagation", Range{-10, 10}, "Weight of the speed along the normal.");
    v.number(&P::curvature, "curvature", Range{0, 10}, "Weight of the mean curvature, which keeps the surface smooth.");
    v.number(&P::advection, "advection", Range{0, 10}, "geodesic: weight of the pull towards edges (ITK-SNAP: 2).");
    v.integer(&P::max_iterations_count, "max_iterations_count", Range{0, 10000}, "Iterations at each resolution.");
    v.number(&P::min_change_mm, "min_change_mm", Range{0, 1},
             "Converged where the surface moves by less than this a step, root mean square; 0 does not ask.");
    v.integer(&P::coarse_levels_count, "coarse_levels_count", Range{0, 4},
              "So many coarser resolutions are evolved first, each of half as many voxels a side.");
    v.number(&P::min_mean_speed, "min_mean_speed", Range{-1, 1},
             "A result whose mean speed inside is below this leaked or lost its structure: refused.");
  }
};

/// Evolves a surface in 3D: d(phi)/dt = -|grad phi| (propagation g + curvature kappa) [- advection grad g . grad phi],
/// phi in mm, positive inside here, g the speed in [-1, 1] (Caselles, Kimmel and Sapiro 1997; Zhu and Yuille 1996; as
/// in ITK-SNAP, Yushkevich et al. 2006). A narrow band on the grid, in mm whatever the spacing; the time step from the
/// CFL bound. `start` is positive inside (any field on the same raster; its crossing is the first surface). Returns the
/// signed field, positive inside, in mm near the surface, cropped as segment() does.
///
/// Report: iterations_count (all levels), stopped_by (converged, iterations), change_mm, time_step, volume_ml. Throws
/// 65 where a voxel is not finite or rasters differ; 80 where the surface vanishes, fills its domain, or the mean speed
/// says that it leaked; Cancelled. The same bits whatever the thread count.
Field evolve_snake(const Field& speed, const Field& start, const SnakeParams& params, Report& report,
                   const Progress& progress = {});

}  // namespace trephine
