// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "head/soft_tissue.h"
#include "head/tissue_params.h"
#include "head/ventricle_parts.h"
#include "place/place_head.h"
#include "segmentation/finish.h"

namespace trephine::head {

struct VentriclesParams {
  double lower_hu = -15;
  double upper_hu = 18.5;
  segmentation::SegmentEdge edge = segmentation::SegmentEdge::half_maximum;
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
    describe_tissue<P>(v);
    v.number(&P::close_mm, "close_mm", Range{0, 30}, "Gaps narrower than twice this are closed.");
    v.number(&P::fill_close_mm, "fill_close_mm", Range{0, 30},
             "Also fill cavities (choroid plexus) whose outlets are narrower than twice this.");
    describe_grow<P>(v);
  }
};

/// Fields of other anatomies (positive inside) on the volume's raster, perhaps covering only a part of it.
struct VentriclesMasks {
  const grid::Field* brain = nullptr;    ///< the brain as find_brain gives it; must be given
  const grid::Field* without = nullptr;  ///< the ventricles lie outside it; null where not given
};

struct VentriclesResult {
  std::optional<TissueLevel> level;  ///< with edge half_maximum
  double tissue_noise_hu_mm1_5 = 0;
  place::PlaceFigures place;
  std::optional<double> blood_ml;           ///< what in them is as dense as fresh blood
  double upper_hu = 0;                      ///< the edge that was used
  std::optional<std::int64_t> horns_count;  ///< with edge half_maximum: traced as tubes
  std::size_t cut_voxels_count = 0;         ///< where the mask ends inside fluid
  VentricleParts parts;
  std::size_t streaked_slices_count = 0;
  segmentation::FinishResult finished;
  template <class V>
  static void describe(V& v) {
    using P = VentriclesResult;
    v.all_of(&P::level);
    v.number(&P::tissue_noise_hu_mm1_5, "tissue_noise_hu_mm1_5", Range{}, "Noise of the brain's tissue.");
    v.all_of(&P::place);
    v.number(&P::blood_ml, "blood_ml", "What in the ventricles is as dense as fresh blood.");
    v.number(&P::upper_hu, "upper_hu", Range{}, "The edge between CSF and white matter that was used.");
    v.integer(&P::horns_count, "horns_count", "Horns that were traced as tubes.");
    v.integer(&P::cut_voxels_count, "cut_voxels_count", Range{}, "Voxels where the mask ends inside fluid.");
    v.all_of(&P::parts);
    v.integer(&P::streaked_slices_count, "streaked_slices_count", Range{}, "Slices that streaks were taken off.");
    v.all_of(&P::finished);
  }
};

/// The lateral ventricles and the third, as a field like that of segment(). They are CSF deep inside the brain, which a
/// seeded watershed separates from cisterns, fourth ventricle and sulci at the narrowest places. With edge
/// half_maximum, temporal and occipital horns that noise separates from the rest are traced as tubes. The surface is
/// then fitted between the voxels: a model of what the scanner would show of it (CSF and the tissue beside it, blurred,
/// averaged over the slice) is fitted to the scan (voxels finer than a millimetre are merged before). Straight streaks
/// across whole slices are taken off before (mask/streaks.h), and said where ventricles lie in them.
///
/// Which CSF is ventricle follows from its place in a template that is registered to the brain (place/place_head.h);
/// the third ventricle is also sought as a slit that no voxel lies in wholly. Warns of parts that are missing or
/// compressed (ventricle_parts.h). Where the template is not sure to fit, it warns, and the head must not be tilted by
/// more than about 15 degrees.
///
/// Blood in the ventricles (ventricle_blood.h) belongs to them, and a warning says how much there is.
///
/// This is a first automatic estimate; a tumour in the ventricles and wide outlets mislead it.
///
/// The result has the same bits whatever the thread count. Throws as segment() does; 64 where no brain is given; 80
/// also where all voxels have one value or the brain is empty.
Outcome<grid::Field, VentriclesResult> find_ventricles(const grid::HuVolume& volume, const VentriclesMasks& masks,
                                                       const VentriclesParams& params, const Progress& progress = {});

}  // namespace trephine::head
