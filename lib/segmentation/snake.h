// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"

namespace trephine::segmentation {

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
             "What drives the surface. region_competition: the sign of the speed, outwards where it is positive and "
             "inwards where it is negative. geodesic: outwards up to image edges, where the speed is near 0.");
    v.number(&P::propagation, "propagation", Range{-10, 10},
             "Weight of the speed along the normal (1 as in ITK-SNAP).");
    v.number(&P::curvature, "curvature", Range{0, 10},
             "Weight of the curvature, which keeps the surface smooth, in mm. At 0.2 (as in ITK-SNAP on voxels of 1 "
             "mm) full speed holds a ball of radius 0.4 mm, and a ball of 4 mm loses a tenth of its speed.");
    v.number(&P::advection, "advection", Range{0, 10},
             "geodesic: weight of the pull towards edges, in mm (2 as in ITK-SNAP); else not used.");
    v.integer(&P::max_iterations_count, "max_iterations_count", Range{0, 10000},
              "Iterations of all resolutions together; the coarser ones take at most half of them.");
    v.number(&P::min_change_mm, "min_change_mm", Range{0, 1},
             "The surface has converged where it moves less than this in an iteration, on average over the surface and "
             "over ten iterations; 0 turns the check off.");
    v.integer(&P::coarse_levels_count, "coarse_levels_count", Range{0, 4},
              "How many coarser resolutions are evolved first, each with half as many voxels along the finer axes.");
    v.number(&P::min_mean_speed, "min_mean_speed", Range{-1, 1},
             "A result whose mean speed inside is below this has lost its structure and is refused; -1 turns the check "
             "off.");
    v.number(&P::max_volume_ml, "max_volume_ml", Range{0, 100000},
             "A surface that grows beyond this volume has leaked and is refused at once; 100000 turns the check off.");
    v.text(&P::bubbles, "bubbles", "Where to begin: balls as \"x,y,z,radius\" in mm, LPS, separated by semicolons.");
    v.integer(&P::bubbles_count, "bubbles_count", Range{0, 100},
              "How many balls are placed automatically: the largest that fit where the speed is positive.");
    v.number(&P::bubble_min_radius_mm, "bubble_min_radius_mm", Range{0.1, 100},
             "Least radius of a ball that is placed automatically.");
  }
};

struct EvolvedResult {
  std::int64_t iterations_count = 0;  ///< of all levels
  std::string stopped_by;             ///< "converged" or "iterations"; of the finest level
  double change_mm = 0, time_step = 0, mean_speed = 0;
  double negative_speed_ratio = 0;  ///< the share of the voxels inside that have a negative speed
  double volume_ml = 0;
  template <class V>
  static void describe(V& v) {
    using P = EvolvedResult;
    v.integer(&P::iterations_count, "iterations_count", Range{}, "Iterations.");
    v.text(&P::stopped_by, "stopped_by", "What it ended by.");
    v.number(&P::change_mm, "change_mm", Range{}, "How far it moved in the last iteration.");
    v.number(&P::time_step, "time_step", Range{}, "The time step.");
    v.number(&P::mean_speed, "mean_speed", Range{}, "Mean speed inside.");
    v.number(&P::negative_speed_ratio, "negative_speed_ratio", Range{}, "Share of the inside with a negative speed.");
    v.number(&P::volume_ml, "volume_ml", Range{}, "Volume.");
  }
};

/// Evolves a surface in 3D over a speed image g in [-1, 1]. In a unit of time it moves outwards along its normal N by
///   propagation g - curvature kappa - advection (grad g . N)
/// where kappa is the sum of both principal curvatures (2 / r of a ball), and the last term applies to geodesic alone
/// ([Zhu1996]; [Caselles1997]; as in ITK-SNAP [Yushkevich2006], but in mm). The surface is a sparse field
/// [Whitaker1998] on the grid (segmentation/snake_band.h), and the time step follows from the CFL bound. A speed of -1,
/// as presegment sets it outside of its masks, is a wall that pulls nothing. Coarser resolutions come first; a
/// structure that vanishes there is begun again at the finer one. `start` is any field on the speed's raster, positive
/// inside, whose zero crossing is the first surface. Only the speed's lattice is used; its edge holds the surface.
///
/// Returns the signed field, positive inside, in mm within two voxels of the surface and constant further away, cropped
/// to the shape and a margin of two voxels. A surface cannot separate noise to which its speed gives the structure's
/// sign, and cannot tell that it leaked: bound it (max_volume_ml), or keep it inside another anatomy (snake()).
///
/// Warns where the speed of more than a twentieth inside is negative (region competition), where the surface still
/// moves, and where it reached the speed image's edge, because it may have leaked.
///
/// Throws Error 65 where a voxel is not finite, the speed is not within [-1, 1] or rasters differ; 64 where every
/// weight is 0; 80 where start is empty on the speed's lattice, or the surface vanishes, fills its domain or exceeds
/// the given bounds; Cancelled. The result has the same bits whatever the thread count. It must not be called from
/// several threads at a time.
Outcome<grid::Field, EvolvedResult> evolve_snake(const grid::Field& speed, const grid::Field& start,
                                                 const SnakeParams& params, const Progress& progress = {});

struct BubbleFigures {
  std::size_t count = 0;
  std::string bubbles;  ///< in the form in which they can be given
  double max_radius_mm = 0;
  template <class V>
  static void describe(V& v) {
    v.integer(&BubbleFigures::count, "bubbles_count", Range{}, "Balls that it began with.");
    v.text(&BubbleFigures::bubbles, "bubbles", "Those balls.");
    v.number(&BubbleFigures::max_radius_mm, "bubble_max_radius_mm", Range{}, "Radius of the largest.");
  }
};
struct SnakeResult {
  std::optional<BubbleFigures> bubbles;  ///< where it began with balls
  EvolvedResult evolved;                 ///< the volume is that within the masks
  double held_by_limits_ratio = 0;       ///< see snake()
  std::size_t pieces_count = 0;          ///< a bubble in other CSF does not leak and yet is no ventricle
  template <class V>
  static void describe(V& v) {
    using P = SnakeResult;
    v.all_of(&P::bubbles);
    v.all_of(&P::evolved);
    v.number(&P::held_by_limits_ratio, "held_by_limits_ratio", Range{}, "Share of the surface that limits hold.");
    v.integer(&P::pieces_count, "pieces_count", Range{}, "Pieces.");
  }
};

/// Fields on the speed's raster, null where not given.
struct SnakeMasks {
  const grid::Field* start = nullptr;    ///< the first surface; without it, the parameters' bubbles
  const grid::Field* within = nullptr;   ///< the surface stays inside it, to a fraction of a voxel
  const grid::Field* without = nullptr;  ///< the surface stays outside it
};

/// evolve_snake() from given or placed bubbles, kept within and without other anatomies. Also throws Error 64 where
/// there is nothing to begin with, or more than one start, or `bubbles` cannot be read; 80 as place_bubbles() does.
/// Warns where a mask holds more than a tenth of the surface at a positive speed (geodesic: also a wall of the speed
/// image): held_by_limits_ratio.
Outcome<grid::Field, SnakeResult> snake(const grid::Field& speed, const SnakeMasks& masks, const SnakeParams& params,
                                        const Progress& progress = {});

}  // namespace trephine::segmentation
