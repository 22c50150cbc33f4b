// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"

namespace trephine::segmentation {

enum class PresegmentMethod { regions, edges, classes };
enum class PresegmentSides { both, lower, upper };

struct PresegmentParams {
  PresegmentMethod method = PresegmentMethod::regions;
  PresegmentSides sides = PresegmentSides::both;
  double lower_hu = 40, upper_hu = 80;
  double smoothness = 3;
  double smooth_range_hu = 0;
  double smoothing_sigma_mm = 0;
  double edge_sigma_mm = 1;
  double edge_kappa = 0.04;
  double edge_kappa_hu_per_mm = 0;
  double edge_exponent = 3;
  int classes_count = 3;
  int first_class = 1, last_class = 1;
  std::array<double, 3> roi_min_mm{-1e6, -1e6, -1e6};
  std::array<double, 3> roi_max_mm{1e6, 1e6, 1e6};

  template <class V>
  static void describe(V& v) {
    using P = PresegmentParams;
    v.choice(&P::method, "method",
             {{"regions", PresegmentMethod::regions},
              {"edges", PresegmentMethod::edges},
              {"classes", PresegmentMethod::classes}},
             "What the speed is made of. regions: inside or outside of a window of HU; edges: image edges (for a "
             "geodesic snake); classes: some tissue classes, found by clustering, against the others.");
    v.choice(&P::sides, "sides",
             {{"both", PresegmentSides::both}, {"lower", PresegmentSides::lower}, {"upper", PresegmentSides::upper}},
             "regions: which thresholds count.");
    v.number(&P::lower_hu, "lower_hu", Range{-100000, 100000}, "regions: lower threshold (ITK-SNAP: 40).");
    v.number(&P::upper_hu, "upper_hu", Range{-100000, 100000}, "regions: upper threshold (ITK-SNAP: 80).");
    v.number(&P::smoothness, "smoothness", Range{0.1, 10},
             "regions: steepness as in ITK-SNAP; halfway between both thresholds the speed is 1 - 2 * 10^-smoothness "
             "(ITK-SNAP: 3).");
    v.number(&P::smooth_range_hu, "smooth_range_hu", Range{0, 100000},
             "regions: HU over which the speed rises. With 0 it is upper_hu - lower_hu, or for one side a third of the "
             "region's range of values, as in ITK-SNAP.");
    v.number(&P::smoothing_sigma_mm, "smoothing_sigma_mm", Range{0, 5},
             "regions, classes: sigma of the Gaussian against noise, applied first.");
    v.number(&P::edge_sigma_mm, "edge_sigma_mm", Range{0, 10},
             "edges: sigma of the Gaussian before the gradient (ITK-SNAP: 1, in voxels).");
    v.number(&P::edge_kappa, "edge_kappa", Range{0.0001, 1},
             "edges: gradient at which the speed is one half, as a share of the steepest in the region (ITK-SNAP: "
             "0.04).");
    v.number(&P::edge_kappa_hu_per_mm, "edge_kappa_hu_per_mm", Range{0, 100000},
             "edges: the same gradient in HU per mm, which metal does not change; 0 uses edge_kappa.");
    v.number(&P::edge_exponent, "edge_exponent", Range{0.1, 10},
             "edges: exponent of the speed's fall with the gradient (ITK-SNAP: 3).");
    v.integer(&P::classes_count, "classes_count", Range{2, 10}, "classes: how many Gaussians (ITK-SNAP: 3).");
    v.integer(&P::first_class, "first_class", Range{1, 10},
              "classes: number of the structure's darkest class, from 1.");
    v.integer(&P::last_class, "last_class", Range{1, 10},
              "classes: number of the structure's brightest class, from 1.");
    v.numbers(&P::roi_min_mm, "roi_min_mm", Range{-1e6, 1e6}, "Lower corner of the region of interest, LPS.");
    v.numbers(&P::roi_max_mm, "roi_max_mm", Range{-1e6, 1e6}, "Upper corner of the region of interest, LPS.");
  }
};

/// Fields on the volume's raster, perhaps covering only a part of it; null where not given.
struct PresegmentMasks {
  const grid::Field* within = nullptr;   ///< outside it the speed is -1, and voxels do not count for ranges and classes
  const grid::Field* without = nullptr;  ///< the same inside it
};

struct ClassFigures {
  double mean_hu = 0, sigma_hu = 0, ratio = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&ClassFigures::mean_hu, "hu", Range{}, "Mean.");
    v.number(&ClassFigures::sigma_hu, "sigma_hu", Range{}, "Sigma.");
    v.number(&ClassFigures::ratio, "ratio", Range{}, "Its share.");
  }
};
struct PresegmentResult {
  std::optional<double> edge_kappa_hu_per_mm;  ///< of edges
  Named<ClassFigures> classes;                 ///< "class_1" and so on, of classes
  double speed_positive_ratio = 0;             ///< of the voxels that count
  template <class V>
  static void describe(V& v) {
    using P = PresegmentResult;
    v.number(&P::edge_kappa_hu_per_mm, "edge_kappa_hu_per_mm", "The gradient at which the speed is half.");
    v.map(&P::classes, "classes", "Each Gaussian.").items_joined("_");
    v.number(&P::speed_positive_ratio, "speed_positive_ratio", Range{}, "Share of the voxels with a speed above 0.");
  }
};

/// The speed image of a volume for evolve_snake(), in [-1, 1], as ITK-SNAP's presegmentation makes it [Yushkevich2006],
/// on the region of interest, cropped to `within` and four voxels:
/// - regions: tanh((I - L) k) + tanh((U - I) k) - 1, positive inside the window; one-sided: a single tanh. k is ln((2 -
///   e) / e) / range with e = 10^-smoothness, range being U - L, or for one side a third of the values' range.
/// - edges: 1 / (1 + (|grad G I| / kappa)^exponent), from 0 at edges to 1, G a Gaussian in mm.
/// - classes: a Gaussian mixture of the values (segmentation/tissue_mixture.h); 2 p - 1, p the probability of the
///   classes from first_class to last_class.
///
/// The same bits whatever the thread count. Throws Error 65 where a voxel is not finite or a mask
/// of another raster; 64 where lower_hu is not below upper_hu or the classes contradict each other; 80 where nothing
/// lies in the region, the image is constant where edges or classes are sought, or the speed is nowhere above 0, or
/// nowhere below 0 with nothing else to hold a surface; Cancelled.
Outcome<grid::Field, PresegmentResult> presegment(const grid::HuVolume& volume, const PresegmentMasks& masks,
                                                  const PresegmentParams& params, const Progress& progress = {});

}  // namespace trephine::segmentation
