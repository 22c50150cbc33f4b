// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "mask/bits.h"
#include "mask/hu_view.h"

namespace trephine::segmentation {

/// Where vessels are sought.
enum class VesselRegion { cranial_cavity, soft_tissue };

struct VesselsParams {
  VesselRegion region = VesselRegion::cranial_cavity;
  double enhancement_hu = 80;
  double smoothing_sigma_mm = 0.6;
  double rim_mm = 1.5;
  double min_component_ml = 0.05;
  double grow_mm = 0;

  template <class V>
  static void describe(V& v) {
    using P = VesselsParams;
    v.choice(
        &P::region, "region",
        {{"cranial_cavity", VesselRegion::cranial_cavity}, {"soft_tissue", VesselRegion::soft_tissue}},
        "Where they are sought: in the cranial cavity, or, of a neck or trunk, in all that is neither bone nor air "
        "nor lung. A trunk breathes: there, give `within`, and look at the result.");
    v.number(&P::enhancement_hu, "enhancement_hu", Range{10, 1000},
             "By how much the angiography is brighter than the CT in a vessel; about half of what its middle has.");
    v.number(&P::smoothing_sigma_mm, "smoothing_sigma_mm", Range{0, 5}, "Sigma of a Gaussian against noise.");
    v.number(
        &P::rim_mm, "rim_mm", Range{0, 5},
        "So near to bone (and within 1.2 voxels of it) the difference of two scans is that of their bone; a vessel "
        "there is continued from beside it.");
    v.number(&P::min_component_ml, "min_component_ml", Range{0, 1000}, "Pieces smaller than this are dropped.");
    v.number(&P::grow_mm, "grow_mm", Range{0, 20}, "Moves the surface outwards by this distance at the end.");
  }
};

struct VesselsResult {
  std::optional<double> cranial_cavity_ml;  ///< where they are sought in it
  double outside_ratio = 0;                 ///< the share of the cavity that the angiography does not show
  double enhancement_median_hu = 0;
  mask::MaskSize size;
  std::size_t pieces_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = VesselsResult;
    v.number(&P::cranial_cavity_ml, "cranial_cavity_ml", "Volume of the cranial cavity.");
    v.number(&P::outside_ratio, "outside_ratio", Range{}, "Share of the cavity outside of the angiography.");
    v.number(&P::enhancement_median_hu, "enhancement_median_hu", Range{}, "How much brighter the vessels are.");
    v.all_of(&P::size);
    v.integer(&P::pieces_count, "pieces_count", Range{}, "Pieces.");
  }
};

/// Soft tissue of the CT, the region of a trunk's vessels: above -150 HU and no bone.
mask::BitMask soft_tissue_around(const grid::HuVolume& ct, const mask::BitMask& bone);

/// The opacified vessels in the cavity (or another region), as a field that is positive inside them: where an
/// angiography is brighter than the CT by enhancement_hu. Both lie on the same voxels. `within` (may be null) is an
/// anatomy that they are sought in, such as the zone of the sagittal sinus; `without` (may be null) one that is left
/// out, with a voxel around it, such as the vein where the artery is sought. Where one of the scans has voxels coarser
/// than about a millimetre, or another sharpness than the other, edges of bone may be taken for vessels.
///
/// Warns where the angiography does not show more than 5 % of the cavity. Throws Error 65 where the volumes or `within`
/// are on other voxels; 80 where more than half of the cavity lies outside, and where no vessel is found. The same bits
/// whatever the thread count.
Outcome<grid::Field, VesselsResult> find_vessels(const grid::HuVolume& angiography, const grid::HuVolume& ct,
                                                 const mask::BitMask& cavity, const grid::Field* within,
                                                 const grid::Field* without, const VesselsParams& params,
                                                 const Progress& progress = {});

}  // namespace trephine::segmentation
