// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "grid/grid.h"

namespace trephine {

enum class SegmentMethod { threshold, brain, ventricles };
enum class SegmentEdge { fixed, half_maximum };
enum class SegmentComponents { all, largest };
enum class SegmentFill { none, cavities, cavities_and_cut };

struct SegmentParams {
  template <class T>
  using ByMethod = DefaultBy<T, SegmentMethod, 3>;
  SegmentMethod method = SegmentMethod::threshold;
  ByMethod<double> lower_hu{{226.5, 22.5, -15}};
  ByMethod<double> upper_hu{{100000, 100000, 18.5}};
  double seed_lower_hu = -100000;
  ByMethod<SegmentEdge> edge{{SegmentEdge::fixed, SegmentEdge::half_maximum, SegmentEdge::half_maximum}};
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

  template <class V>
  static void describe(V& v) {
    using P = SegmentParams;
    v.choice(&P::method, "method",
             {{"threshold", SegmentMethod::threshold},
              {"brain", SegmentMethod::brain},
              {"ventricles", SegmentMethod::ventricles}},
             "How: a window of HU; the brain's outer envelope inside the skull; the ventricles inside the brain.");
    v.number(&P::lower_hu, "lower_hu", Range{-100000, 100000},
             "Lowest HU of the material (brain: the edge between CSF and grey matter).", &P::method, "method");
    v.number(&P::upper_hu, "upper_hu", Range{-100000, 100000},
             "Highest HU of the material (ventricles: the edge between CSF and white matter).", &P::method, "method");
    v.number(&P::seed_lower_hu, "seed_lower_hu", Range{-100000, 100000},
             "Hysteresis: only pieces that hold a voxel of at least this HU.");
    v.choice(&P::edge, "edge", {{"fixed", SegmentEdge::fixed}, {"half_maximum", SegmentEdge::half_maximum}},
             "Where the surface lies: at the HU given, or halfway between both sides as measured (threshold: at every "
             "place, never below lower_hu; brain, ventricles: HU given for a scan whose brain is at 30, and moved with "
             "it).",
             &P::method, "method");
    v.number(&P::smoothing_sigma_mm, "smoothing_sigma_mm", Range{0, 5},
             "Sigma of the Gaussian against noise before the thresholds; where it is 0, brain uses 1, ventricles 1.1.");
    v.numbers(&P::roi_min_mm, "roi_min_mm", Range{-1e6, 1e6}, "Lower corner of the region of interest, LPS.");
    v.numbers(&P::roi_max_mm, "roi_max_mm", Range{-1e6, 1e6}, "Upper corner of the region of interest, LPS.");
    v.number(&P::open_mm, "open_mm", Range{0, 10},
             "Parts that hang together only by bridges thinner than twice this are told apart (head and head holder); "
             "brain: 2 where it is 0.");
    v.choice(&P::components, "components", {{"all", SegmentComponents::all}, {"largest", SegmentComponents::largest}},
             "Which connected pieces to keep.");
    v.number(&P::min_component_ml, "min_component_ml", Range{0, 10000}, "Pieces smaller than this are dropped.");
    v.number(&P::close_mm, "close_mm", Range{0, 30},
             "Gaps narrower than twice this are closed; brain: 3 where it is 0.");
    v.choice(&P::fill, "fill",
             {{"none", SegmentFill::none},
              {"cavities", SegmentFill::cavities},
              {"cavities_and_cut", SegmentFill::cavities_and_cut}},
             "Fill what the material encloses; cavities_and_cut: also what only one face of the volume cuts open.");
    v.number(&P::fill_close_mm, "fill_close_mm", Range{0, 30},
             "Fill also cavities whose ways out are narrower than twice this; the outer surface stays where it is; "
             "brain: 10 where it is 0.");
    v.number(&P::fill_max_ml, "fill_max_ml", Range{0, 10000}, "Cavities larger than this stay open.");
    v.number(&P::grow_mm, "grow_mm", Range{-20, 20},
             "Moves the surface outwards (or inwards, below 0) by this distance in the end; the field is then in mm.");
    v.number(&P::max_scan_edge_ratio, "max_scan_edge_ratio", Range{0, 1},
             "Refuse a shape more of whose rim in the slices than this is the edge of the scanned field: a skin that "
             "was not scanned; 1 does not ask.");
  }
};

/// Fields of other anatomies (positive inside), on the volume's raster, maybe only a part of it. Null where not given.
struct SegmentMasks {
  const Field* within = nullptr;   ///< nothing outside it; method ventricles: the brain
  const Field* without = nullptr;  ///< nothing inside it
  const Field* skull = nullptr;    ///< method brain: the bone that encloses it; else bone is what exceeds 226 HU
};

/// One anatomy out of a volume of HU: a field, positive inside, whose zero crossing is the surface, cropped to the
/// shape and a margin of two voxels where the volume has room. The mask that the parameters decide gives the sign; the
/// values beside the surface are HU against the threshold (so that partial volume places it within a voxel), or a
/// smoothed cut where the mask ends inside material. No voxel is 0.
///
/// - threshold: window, masks, hysteresis, opening by pieces, components, closing, filling, in this order. With edge
///   half_maximum the fixed threshold decides what is bone and the surface lies at half the contrast, which kernel blur
///   moves far less.
/// - brain: the space in the skull is found on a 2 mm raster by a watershed on the distance to bone, so that every
///   foramen is cut at its narrowest. Inside it, on cells of at most 1 mm, HU are levelled (half_maximum: tissue to 30
///   everywhere) and denoised as strongly as their noise needs (means along edges and sulci, then total variation);
///   tissue brighter than CSF, opened, closed and filled, is the
///   envelope, from which sulci, fissures and cisterns are cut as far as CSF reaches in from outside. Ventricles
///   belong to the brain, the fourth too where its ways out are narrower than 4 mm; wide dark places that are not as
///   dark as CSF (oedema, old infarcts) too.
/// - ventricles: CSF deep inside the brain (the lateral ones and the third), parted from cisterns, fourth ventricle and
///   sulci at the narrowest places by the same watershed; half_maximum: temporal and occipital horns that noise parts
///   from the rest are traced as tubes, and the surface is fitted: a model of what the scanner shows of it (CSF and the
///   tissue beside it, blurred, averaged over the slice) to the scan, between the voxels (those finer than a millimetre
///   are merged before).
///
/// Brain and ventricles are a first unattended estimate for a head that lies straight to about 15 degrees: blood or a
/// tumour in the ventricles, wide ways out of them, strong cupping and a skull with a large defect mislead it. The
/// report says what was found ("volume_ml", ...), and warns where it is implausible.
///
/// The result is the same bits whatever the thread count. Safe to call from several threads at a time.
/// Throws Error 65 where a voxel is not finite, or a mask is of another raster; 64 where ventricles have no brain
/// given, or the region's corners are exchanged; 80 where brain or ventricles are sought in a volume of one value, the
/// mask is empty, fills the volume, or lies in a single slice, with the count of voxels, or more
/// of its rim than max_scan_edge_ratio is the edge of the scan; Cancelled.
Field segment(const HuVolume& volume, const SegmentMasks& masks, const SegmentParams& params, Report& report,
              const Progress& progress = {});

}  // namespace trephine
