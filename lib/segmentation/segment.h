// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "segmentation/finish.h"

namespace trephine::segmentation {

enum class SegmentEdge { fixed, half_maximum };
enum class SegmentComponents { all, largest };
enum class SegmentFill { none, cavities, cavities_and_cut };

struct SegmentParams {
  double lower_hu = 226.5;
  double upper_hu = 100000;
  double seed_lower_hu = -100000;
  SegmentEdge edge = SegmentEdge::fixed;
  double smoothing_sigma_mm = 0;
  std::array<double, 3> roi_min_mm{-1e6, -1e6, -1e6};
  std::array<double, 3> roi_max_mm{1e6, 1e6, 1e6};
  double open_mm = 0;
  SegmentComponents components = SegmentComponents::all;
  double min_component_ml = 0;
  double close_mm = 0;
  SegmentFill fill = SegmentFill::none;
  double fill_close_mm = 0;
  double fill_max_ml = 1000;
  double grow_mm = 0;
  double max_scan_edge_ratio = 1;
  double coarse_mm = 0;

  template <class V>
  static void describe(V& v) {
    using P = SegmentParams;
    v.number(&P::lower_hu, "lower_hu", Range{-100000, 100000}, "Lowest HU of the material.");
    v.number(&P::upper_hu, "upper_hu", Range{-100000, 100000}, "Highest HU of the material.");
    v.number(&P::seed_lower_hu, "seed_lower_hu", Range{-100000, 100000},
             "Hysteresis: only pieces that hold a voxel of at least this HU are kept.");
    v.choice(&P::edge, "edge", {{"fixed", SegmentEdge::fixed}, {"half_maximum", SegmentEdge::half_maximum}},
             "Where the surface lies. fixed: at the given HU. half_maximum: halfway between the HU of both sides as "
             "measured at every place, never below lower_hu.");
    v.number(&P::smoothing_sigma_mm, "smoothing_sigma_mm", Range{0, 5},
             "Sigma of the Gaussian against noise before the thresholds.");
    v.numbers(&P::roi_min_mm, "roi_min_mm", Range{-1e6, 1e6}, "Lower corner of the region of interest, LPS.");
    v.numbers(&P::roi_max_mm, "roi_max_mm", Range{-1e6, 1e6}, "Upper corner of the region of interest, LPS.");
    v.number(&P::open_mm, "open_mm", Range{0, 10},
             "Parts that are connected only by bridges thinner than twice this are separated (head and head holder).");
    v.choice(&P::components, "components", {{"all", SegmentComponents::all}, {"largest", SegmentComponents::largest}},
             "Which connected pieces to keep.");
    v.number(&P::min_component_ml, "min_component_ml", Range{0, 10000}, "Pieces smaller than this are dropped.");
    v.number(&P::close_mm, "close_mm", Range{0, 30}, "Gaps narrower than twice this are closed.");
    v.choice(&P::fill, "fill",
             {{"none", SegmentFill::none},
              {"cavities", SegmentFill::cavities},
              {"cavities_and_cut", SegmentFill::cavities_and_cut}},
             "Fill what the material encloses; cavities_and_cut: also what only one face of the volume cuts open.");
    v.number(
        &P::fill_close_mm, "fill_close_mm", Range{0, 30},
        "Also fill cavities whose outlets are narrower than twice this; the outer surface stays where it is. Holes "
        "through the material (a burr hole, a foramen) that are narrower are closed too; wider ones keep their "
        "walls. filled_by_closing_ml says how much was filled only because of this.");
    v.number(&P::fill_max_ml, "fill_max_ml", Range{0, 10000}, "Cavities larger than this stay open.");
    v.number(&P::grow_mm, "grow_mm", Range{-20, 20},
             "Moves the surface outwards (inwards, if negative) by this distance at the end; the field is then in mm.");
    v.number(&P::max_scan_edge_ratio, "max_scan_edge_ratio", Range{0, 1},
             "Refuse a shape if a larger share of its rim in the slices is the edge of the scanned field, as with a "
             "skin that was not scanned completely; 1: none is refused, but one that is mostly that edge is told.");
    v.number(&P::coarse_mm, "coarse_mm", Range{0, 10},
             "Work on cells of about this size, each as bright as its brightest voxel, in a fraction of the time. It "
             "is for an anatomy that others only lie within: the result is up to a cell too large, and its surface has "
             "steps. 0: work on the scan's voxels.");
  }
};

/// Fields of other anatomies (positive inside) on the volume's raster, perhaps covering only a part of it. Null where
/// not given.
struct SegmentMasks {
  const grid::Field* within = nullptr;   ///< the anatomy lies inside it
  const grid::Field* without = nullptr;  ///< the anatomy lies outside it
};

struct SegmentResult {
  std::optional<double> bright_rim_ml;       ///< that was left out
  std::optional<std::int64_t> pieces_count;  ///< where pieces are chosen
  std::optional<double> filled_ml;
  std::optional<double> filled_by_closing_ml;  ///< of that, what is filled only because outlets were closed
  std::optional<double> even_ml;               ///< the largest even piece, with hysteresis, where noise is known
  std::size_t cut_voxels_count = 0;            ///< where the mask ends inside material
  FinishResult finished;
  template <class V>
  static void describe(V& v) {
    using P = SegmentResult;
    v.number(&P::bright_rim_ml, "bright_rim_ml", "The bright rim that was left out.");
    v.integer(&P::pieces_count, "pieces_count", "Pieces before some were chosen.");
    v.number(&P::filled_ml, "filled_ml", "What was filled.");
    v.number(&P::filled_by_closing_ml, "filled_by_closing_ml", "What was filled only because outlets were closed.");
    v.number(&P::even_ml, "even_ml", "The largest piece of its inside that is as even as blood.");
    v.integer(&P::cut_voxels_count, "cut_voxels_count", Range{}, "Voxels where the mask ends inside material.");
    v.all_of(&P::finished);
  }
};

/// Finds one anatomy in a volume of HU by thresholds. The result is a field, positive inside, whose zero crossing is
/// the surface, cropped to the shape and a margin of two voxels where the volume has room. The mask that the parameters
/// decide gives the sign. The values beside the surface are HU relative to the threshold (so that partial volume places
/// the surface within a voxel), or a smoothed cut where the mask ends inside material. No voxel is 0.
///
/// The steps, in this order: window, masks, hysteresis, opening by pieces, components, closing, filling. With edge
/// half_maximum the fixed threshold decides what is bone, and the surface lies at half the contrast, which kernel blur
/// moves far less. With coarse_mm the work is done on cells of whole voxels: the shape then contains that of the scan's
/// own voxels, provided the shape is everything above lower_hu, and the field has steps of a cell.
///
/// With hysteresis inside another anatomy (bone in the skin), what lies within 2 mm of that one's surface and not
/// beside a deeper part of the material is left out where it is 2 ml or more: a kernel that enhances
/// edges makes the skin's rim as bright as bone.
///
/// With hysteresis, by which bone is found, it warns where vessels or organs with contrast medium are part of the shape
/// (even_core.h).
///
/// The result has the same bits whatever the thread count, and the function is safe to call from several threads at a
/// time. Throws Error 65 where a voxel is not finite, or a mask is on another raster; 64 where coarse_mm is set and a
/// mask is given, or corners or thresholds are exchanged; 80, with the count of voxels, where the mask is empty, fills
/// the volume, or lies in a single slice, or where more of its rim than max_scan_edge_ratio is the edge of the scan;
/// Cancelled.
Outcome<grid::Field, SegmentResult> segment(const grid::HuVolume& volume, const SegmentMasks& masks,
                                            const SegmentParams& params, const Progress& progress = {});

}  // namespace trephine::segmentation
