// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "trunk/clavicle.h"

namespace trephine::trunk {

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
             "The patient's side; both: the veins of all clavicles that are found, at least one.");
    v.choice(&P::source, "source", {{"automatic", VeinSource::automatic}, {"estimated", VeinSource::estimated}},
             "automatic: from contrast medium where the vein holds any, else estimated.");
    v.number(&P::min_contrast_hu, "min_contrast_hu", Range{20, 1000},
             "The vein counts as enhanced where it is this much brighter than the tissue around it.");
    v.number(&P::search_mm, "search_mm", Range{5, 60}, "Contrast medium is searched for this far around the estimate.");
    v.number(&P::radius_mm, "radius_mm", Range{1, 15}, "Radius of an estimated vein.");
    v.number(&P::gap_mm, "gap_mm", Range{0, 20}, "Distance from the clavicle's surface to that of an estimated vein.");
    v.number(&P::lateral_ratio, "lateral_ratio", Range{0.1, 1},
             "The vein reaches from the clavicle's sternal end to this share of the clavicle's length.");
    v.number(&P::medial_mm, "medial_mm", Range{0, 60},
             "How far the vein continues beyond the sternal end, downwards and to the middle.");
  }
};

struct VeinFigures {
  std::string source;  ///< "contrast" or "estimated"
  double contrast_hu = 0, length_mm = 0;
  double radius_mm = 0;  ///< mean
  double volume_ml = 0;
  double clearance_mm = 0;  ///< the least distance of the estimated middle line to bone and air
  template <class V>
  static void describe(V& v) {
    using P = VeinFigures;
    v.text(&P::source, "source", "What it is from.");
    v.number(&P::contrast_hu, "contrast_hu", Range{}, "How much brighter it is than the tissue about it.");
    v.number(&P::length_mm, "length_mm", Range{}, "Length.");
    v.number(&P::radius_mm, "radius_mm", Range{}, "Mean radius.");
    v.number(&P::volume_ml, "ml", Range{}, "Volume.");
    v.number(&P::clearance_mm, "clearance_mm", Range{}, "Least distance of the estimate to bone and air.");
  }
};
struct VeinResult {
  Named<double> lung_ml;     ///< that the scan shows on each side, where the lungs are given
  Named<VeinFigures> sides;  ///< "right" and "left", as far as found
  mask::MaskSize size;
  template <class V>
  static void describe(V& v) {
    using P = VeinResult;
    v.map(&P::lung_ml, "lung", "Lung of a side.").items_between("", "_lung_ml");
    v.map(&P::sides, "sides", "The vein of each side.").items_joined("_");
    v.all_of(&P::size);
  }
};

/// The subclavian vein and the beginning of the brachiocephalic vein behind and below each clavicle.
///
/// Its course is first estimated from the clavicle: the vein lies behind and below the clavicle's medial third
/// [Tan2000], and is pushed away from bone and lung. If soft tissue within search_mm of it holds a connected piece that
/// is min_contrast_hu brighter, follows most of the course and is as thick as a vein, that piece is the vein, and its
/// surface lies at half the contrast. If there is none (no contrast medium, or only in other vessels), the vein is a
/// tube of radius_mm along the estimate, which shows where a vein usually runs, not where this one does.
///
/// An artery that is also enhanced, and touches the vein or lies nearer to the estimate, is taken for the vein or
/// joined with it: look at the overlays. We chose radius and gap in the range that anatomy books give; they were not
/// measured here.
///
/// Returns a field in about mm, positive inside, on a part of the volume's raster, as segment() does. `bone` is as for
/// find_clavicles. Warns of every estimated vein. The result has the same bits whatever the thread count. Throws Error
/// 65 where a raster differs; 80 where the bone is empty or no clavicle of the requested side is found; Cancelled.
///
/// With the lungs (positive inside), warns where a side has less than 20 ml of them: a needle that goes to that vein
/// meets neither lung nor pleura, and a lesson cannot judge whether it did. Warns too where slices without a lung lie
/// between slices that show much of it, and where one lung ends 60 mm above the other one.
Outcome<grid::Field, VeinResult> find_vein(const grid::HuVolume& volume, const grid::Field& bone,
                                           const VeinParams& params, const Progress& progress = {},
                                           const grid::Field* lung = nullptr);

}  // namespace trephine::trunk
