// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "grid/grid.h"

namespace trephine {

enum class SnakeMethod { region_competition, geodesic };

struct SnakeParams {
  SnakeMethod method = SnakeMethod::region_competition;
  double propagation = 1.0, curvature = 0.2, advection = 2.0;
  int max_iterations_count = 600;
  double min_change_mm = 0.002;
  int coarse_levels_count = 1;
  double min_mean_speed = -1;
  double max_volume_ml = 100000;
  std::string bubbles;
  int bubbles_count = 0;
  double bubble_min_radius_mm = 2;

  template <class V>
  static void describe(V& v) {
    using P = SnakeParams;
    v.choice(&P::method, "method",
             {{"region_competition", SnakeMethod::region_competition}, {"geodesic", SnakeMethod::geodesic}},
             "What drives the surface: the speed's sign, outwards where it is positive and inwards where negative; or "
             "outwards up to image edges, where the speed is near 0.");
    v.number(&P::propagation, "propagation", Range{-10, 10},
             "Weight of the speed along the normal (1 as in ITK-SNAP).");
    v.number(
        &P::curvature, "curvature", Range{0, 10},
        "Weight of the curvature, which keeps the surface smooth, in mm: at 0.2 (as in ITK-SNAP on voxels of 1 mm) "
        "full speed holds a ball of radius 0.4 mm, and one of 4 mm loses a tenth of it.");
    v.number(&P::advection, "advection", Range{0, 10},
             "geodesic: weight of the pull towards edges, in mm (2 as in ITK-SNAP); else not used.");
    v.integer(&P::max_iterations_count, "max_iterations_count", Range{0, 10000},
              "Iterations, those of all resolutions together; the coarser ones take half of them at most.");
    v.number(&P::min_change_mm, "min_change_mm", Range{0, 1},
             "Converged where the surface gets no farther than this an iteration, on the mean over it and over ten "
             "iterations; 0 does not ask.");
    v.integer(&P::coarse_levels_count, "coarse_levels_count", Range{0, 4},
              "So many coarser resolutions are evolved first, each of half as many voxels along the finer axes.");
    v.number(&P::min_mean_speed, "min_mean_speed", Range{-1, 1},
             "A result whose mean speed inside is below this lost its structure: refused; -1 does not ask.");
    v.number(&P::max_volume_ml, "max_volume_ml", Range{0, 100000},
             "A surface that grows beyond this volume leaked: refused at once; 100000 does not ask.");
    v.text(&P::bubbles, "bubbles",
           "Where to begin: balls as \"x,y,z,radius\" in mm, LPS, several parted by semicolons.");
    v.integer(&P::bubbles_count, "bubbles_count", Range{0, 100},
              "So many balls are placed by themselves: the largest that fit where the speed is positive.");
    v.number(&P::bubble_min_radius_mm, "bubble_min_radius_mm", Range{0.1, 100},
             "Least radius of a ball placed by itself.");
  }
};

/// Evolves a surface in 3D over a speed image g in [-1, 1]: it moves outwards along its normal N by
///   propagation g - curvature kappa - advection (grad g . N)
/// a unit of time, kappa the sum of both principal curvatures (2 / r of a ball), the last term for geodesic alone
/// ([Zhu1996]; [Caselles1997]; as in ITK-SNAP [Yushkevich2006], but in mm). It is a sparse field [Whitaker1998] on the
/// grid (segmentation/snake_band.h); the time step from the CFL bound; a speed of -1 is a wall that pulls nothing, as
/// presegment makes it outside of its masks; first at the coarser resolutions, where a structure that vanishes there is
/// begun anew at the finer one. `start` is positive inside, any field on the speed's raster; its crossing is the first
/// surface. Only speed's lattice is looked at; its edge holds the surface.
///
/// Returns the signed field, positive inside, mm within two voxels of the surface and a constant further away, cropped
/// to the shape and a margin of two voxels. A surface does not part from noise that its speed calls its own, nor see
/// that it leaked: bound it (max_volume_ml), or keep it inside another anatomy (snake()).
///
/// Report: iterations_count (all levels), stopped_by (converged, iterations; of the finest), change_mm, time_step,
/// mean_speed, negative_speed_ratio (of the voxels inside, those of negative speed), volume_ml. Warns where more than a
/// twentieth is negative (region competition), where it still moves, and where it reached the speed image's edge: it
/// may have leaked. Throws 65 where a voxel is not finite, the speed is not within [-1, 1] or rasters differ; 64 where
/// every weight is 0; 80 where start is empty on the speed's lattice, or the surface vanishes, fills its domain or
/// exceeds the bounds given; Cancelled. The same bits whatever the thread count; not from several threads at a time.
Field evolve_snake(const Field& speed, const Field& start, const SnakeParams& params, Report& report,
                   const Progress& progress = {});

/// Fields on the speed's raster, null where not given.
struct SnakeMasks {
  const Field* start = nullptr;    ///< the first surface; else the parameters' bubbles
  const Field* within = nullptr;   ///< nothing outside it, to a fraction of a voxel
  const Field* without = nullptr;  ///< nothing inside it
};

/// evolve_snake() from given or placed bubbles, kept within and without other anatomies. Also throws 64 where there is
/// nothing to begin with, more than one thing, or `bubbles` cannot be read; 80 as place_bubbles() does. Report,
/// besides: bubbles (as they can be given) and pieces_count, for a bubble in other CSF leaks nowhere and is
/// still none of the ventricles; held_by_limits_ratio, of the surface, where a mask holds it at a positive speed
/// (geodesic: a wall of the speed image too); warns above a tenth.
Field snake(const Field& speed, const SnakeMasks& masks, const SnakeParams& params, Report& report,
            const Progress& progress = {});

}  // namespace trephine
