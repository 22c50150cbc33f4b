// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "trunk/clavicle.h"

namespace trephine {

enum class VeinSource { automatic, estimated };

struct VeinParams {
  BodySide side = BodySide::both;
  VeinSource source = VeinSource::automatic;
  double min_contrast_hu = 40;
  double search_mm = 18;
  double radius_mm = 5;
  double gap_mm = 3;
  double lateral_ratio = 0.5;
  double medial_mm = 25;

  template <class V>
  static void describe(V& v) {
    using P = VeinParams;
    v.choice(&P::side, "side", {{"both", BodySide::both}, {"left", BodySide::left}, {"right", BodySide::right}},
             "The patient's side; both: of every clavicle that is found, one at least.");
    v.choice(&P::source, "source", {{"automatic", VeinSource::automatic}, {"estimated", VeinSource::estimated}},
             "automatic: from contrast medium where the vein holds any, else estimated.");
    v.number(&P::min_contrast_hu, "min_contrast_hu", Range{20, 1000},
             "The vein counts as enhanced where it is so much brighter than the tissue around it.");
    v.number(&P::search_mm, "search_mm", Range{5, 60}, "Contrast medium is looked for this far around the estimate.");
    v.number(&P::radius_mm, "radius_mm", Range{1, 15}, "Radius of an estimated vein.");
    v.number(&P::gap_mm, "gap_mm", Range{0, 20}, "From the clavicle's surface to that of an estimated vein.");
    v.number(&P::lateral_ratio, "lateral_ratio", Range{0.1, 1},
             "The vein is made from the sternal end to this share of the clavicle's length.");
    v.number(&P::medial_mm, "medial_mm", Range{0, 60}, "And so far on from there, downwards to the middle.");
  }
};

/// The subclavian vein and the beginning of the brachiocephalic vein behind and below each clavicle.
///
/// Its course is first estimated from the clavicle: the vein lies behind and below its medial third [Tan2000], pushed
/// away from bone and lung. Where soft tissue within search_mm of it holds a connected piece that is min_contrast_hu
/// brighter, follows most of the course and is as thick as a vein, that piece is the vein, its surface at half the
/// contrast. Where none does (no contrast medium, or only in other vessels) the vein is a tube of radius_mm along the
/// estimate, which says where a vein usually runs, not where this one does.
///
/// An artery that is enhanced as well, and touches the vein or lies nearer to the estimate, is taken for it or with it:
/// look at the overlays. Radius and gap are ours, of the order that anatomy books give; they were not measured here.
///
/// Returns a field of about mm, positive inside, on a part of the volume's raster, as segment() does. `bone` as for
/// find_clavicles. Report for each side found ("right_", "left_"): source (contrast, estimated), contrast_hu,
/// length_mm, radius_mm (mean), ml, clearance_mm (the estimated middle line's least distance to bone and air). Warns of
/// every estimated vein. The same bits whatever the thread count. Throws Error 65 where a raster differs; 80 where the
/// bone is empty or no clavicle of the side asked for is found; Cancelled.
Field find_vein(const HuVolume& volume, const Field& bone, const VeinParams& params, Report& report,
                const Progress& progress = {});

}  // namespace trephine
