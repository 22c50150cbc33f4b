// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "head/soft_tissue.h"
#include "head/tissue_params.h"
#include "mask/scan_figures.h"
#include "place/place_head.h"
#include "segmentation/finish.h"

namespace trephine::head {

struct BrainParams {
  double lower_hu = 22.5;
  double upper_hu = 100000;
  segmentation::SegmentEdge edge = segmentation::SegmentEdge::half_maximum;
  double smoothing_sigma_mm = 0;
  std::array<double, 3> roi_min_mm{-1e6, -1e6, -1e6};
  std::array<double, 3> roi_max_mm{1e6, 1e6, 1e6};
  double open_mm = 2;
  double close_mm = 3;
  double fill_close_mm = 10;
  double fill_max_ml = 1000;
  double grow_mm = 0;

  template <class V>
  static void describe(V& v) {
    using P = BrainParams;
    v.number(&P::lower_hu, "lower_hu", Range{-100000, 100000}, "The edge between CSF and grey matter, HU.");
    v.number(&P::upper_hu, "upper_hu", Range{-100000, 100000}, "Highest HU of brain.");
    describe_tissue<P>(v);
    v.number(&P::open_mm, "open_mm", Range{0, 10}, "Bridges (vessels, dura, nerves) thinner than twice this are cut.");
    v.number(&P::close_mm, "close_mm", Range{0, 30}, "Sulci narrower than twice this belong to the envelope.");
    v.number(&P::fill_close_mm, "fill_close_mm", Range{0, 30},
             "Cavities whose outlets are narrower than twice this, such as the ventricles, belong to the envelope.");
    v.number(&P::fill_max_ml, "fill_max_ml", Range{0, 10000}, "Cavities larger than this stay open.");
    describe_grow<P>(v);
  }
};

/// Fields of other anatomies (positive inside) on the volume's raster, perhaps covering only a part of it. Null where
/// not given.
struct BrainMasks {
  const grid::Field* skull = nullptr;    ///< the bone around the brain; without it, bone is every voxel above 226 HU
  const grid::Field* within = nullptr;   ///< the brain lies inside it
  const grid::Field* without = nullptr;  ///< the brain lies outside it
  /// Gives what measure_scan says of the volume, for callers who know it already; empty: it is measured here.
  std::function<mask::ScanFigures(const Progress& progress)> scan_figures;
};

struct BrainResult {
  double cranial_cavity_ml = 0;
  std::optional<TissueLevel> level;  ///< with edge half_maximum
  double tissue_noise_hu_mm1_5 = 0;
  double filled_ml = 0, envelope_ml = 0;
  place::PlaceFigures place;
  double dark_tissue_ml = 0, noise_pits_ml = 0;
  std::size_t cut_voxels_count = 0;  ///< where the mask ends inside tissue
  segmentation::FinishResult finished;
  template <class V>
  static void describe(V& v) {
    using P = BrainResult;
    v.number(&P::cranial_cavity_ml, "cranial_cavity_ml", Range{}, "Volume of the cranial cavity.");
    v.all_of(&P::level);
    v.number(&P::tissue_noise_hu_mm1_5, "tissue_noise_hu_mm1_5", Range{}, "Noise of the brain's tissue.");
    v.number(&P::filled_ml, "filled_ml", Range{}, "Cavities in the envelope that were filled.");
    v.number(&P::envelope_ml, "envelope_ml", Range{}, "The brain with its sulci.");
    v.all_of(&P::place);
    v.number(&P::dark_tissue_ml, "dark_tissue_ml", Range{}, "Dark tissue that was left in place.");
    v.number(&P::noise_pits_ml, "noise_pits_ml", Range{}, "Pits of noise that were left in place.");
    v.integer(&P::cut_voxels_count, "cut_voxels_count", Range{}, "Voxels where the mask ends inside tissue.");
    v.all_of(&P::finished);
  }
};

/// The brain's outer surface with sulci, fissures and cisterns, as a field like that of segment().
///
/// The space in the skull is found on a 2 mm raster by a seeded watershed on the distance to bone, so that every
/// foramen is cut at its narrowest place. Inside it, on cells of at most 1 mm, HU are levelled (half_maximum: tissue is
/// at 30 everywhere) and denoised as strongly as their noise needs (means along edges and sulci, then total variation).
/// Tissue brighter than CSF, opened, closed and filled, is the envelope. Sulci, fissures and cisterns are cut from it
/// as far as CSF reaches in from outside. The ventricles belong to the brain, also the fourth where its outlets are
/// narrower than 4 mm, and so do wide dark places that are not as dark as CSF (oedema, old infarcts).
///
/// A sulcus is cut only where the scan shows one beyond its noise, locally where streaks make that stronger
/// (brain_pits.h). The ventricles are told from cisterns and fissures by
/// their place in a template that is registered to the envelope (place/place_head.h), and the brain ends at that
/// template's foramen magnum. Where the template is not sure to fit, a warning says so, the head must not be tilted by
/// more than about 15 degrees, and the brain ends where the spinal canal begins to be narrow.
///
/// This is a first automatic estimate; strong cupping misleads it, and brain that bulges out of a skull with a large
/// defect is cut off. Warns where what was found is implausible, as where the envelope fills less than 85 % of the
/// space that bone encloses.
///
/// The result has the same bits whatever the thread count. Throws as segment() does; 80 also where all voxels have one
/// value, or no space enclosed by bone is found.
Outcome<grid::Field, BrainResult> find_brain(const grid::HuVolume& volume, const BrainMasks& masks,
                                             const BrainParams& params, const Progress& progress = {});

}  // namespace trephine::head
