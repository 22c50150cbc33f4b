// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "segmentation/segment.h"

namespace trephine {

struct VentriclesParams {
  double lower_hu = -15;
  double upper_hu = 18.5;
  SegmentEdge edge = SegmentEdge::half_maximum;
  double smoothing_sigma_mm = 0;
  std::array<double, 3> roi_min_mm{-1e6, -1e6, -1e6};
  std::array<double, 3> roi_max_mm{1e6, 1e6, 1e6};
  double close_mm = 0;
  double fill_close_mm = 0;
  double grow_mm = 0;

  template <class V>
  static void describe(V& v) {
    using P = VentriclesParams;
    v.number(&P::lower_hu, "lower_hu", Range{-100000, 100000}, "Lowest HU of CSF.");
    v.number(&P::upper_hu, "upper_hu", Range{-100000, 100000}, "The edge between CSF and white matter, HU.");
    v.choice(&P::edge, "edge", {{"fixed", SegmentEdge::fixed}, {"half_maximum", SegmentEdge::half_maximum}},
             "Where the surface lies: at the HU given; or at the HU given for a scan whose brain is at 30, and moved "
             "with it.");
    v.number(&P::smoothing_sigma_mm, "smoothing_sigma_mm", Range{0, 5},
             "Sigma of a Gaussian against noise, besides the denoising that is done anyway.");
    v.numbers(&P::roi_min_mm, "roi_min_mm", Range{-1e6, 1e6}, "Lower corner of the region of interest, LPS.");
    v.numbers(&P::roi_max_mm, "roi_max_mm", Range{-1e6, 1e6}, "Upper corner of the region of interest, LPS.");
    v.number(&P::close_mm, "close_mm", Range{0, 30}, "Gaps narrower than twice this are closed.");
    v.number(&P::fill_close_mm, "fill_close_mm", Range{0, 30},
             "Fill also cavities (choroid plexus) whose ways out are narrower than twice this.");
    v.number(&P::grow_mm, "grow_mm", Range{-20, 20},
             "Moves the surface outwards (or inwards, below 0) by this distance in the end; the field is then in mm.");
  }
};

/// Fields of other anatomies (positive inside), on the volume's raster, maybe only a part of it.
struct VentriclesMasks {
  const Field* brain = nullptr;    ///< what holds them, as find_brain gives it; must be given
  const Field* without = nullptr;  ///< nothing inside it; null where not given
};

/// The lateral ventricles and the third, as a field like segment()'s: CSF deep inside the brain, parted from cisterns,
/// fourth ventricle and sulci at the narrowest places by a seeded watershed. With edge half_maximum, temporal and
/// occipital horns that noise parts from the rest are traced as tubes, and the surface is fitted: a model of what the
/// scanner shows of it (CSF and the tissue beside it, blurred, averaged over the slice) to the scan, between the voxels
/// (those finer than a millimetre are merged before).
///
/// A first unattended estimate for a head that lies straight to about 15 degrees: blood or a tumour in the ventricles
/// and wide ways out of them mislead it. The report says what was found, and warns where it is implausible.
///
/// The result is the same bits whatever the thread count. Throws as segment() does; 64 where no brain is given, 80 also
/// where the volume has one value or the brain is empty.
Field find_ventricles(const HuVolume& volume, const VentriclesMasks& masks, const VentriclesParams& params,
                      Report& report, const Progress& progress = {});

}  // namespace trephine
