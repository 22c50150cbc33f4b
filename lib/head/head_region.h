// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"

namespace trephine::head {

struct HeadRegionParams {
  double below_mm = 90;
  double margin_mm = 10;
  double tissue_hu = -300;

  template <class V>
  static void describe(V& v) {
    using P = HeadRegionParams;
    v.number(&P::below_mm, "below_mm", Range{20, 400},
             "How far below the foramen magnum the head's region reaches; 90 keeps the jaw and the upper neck.");
    v.number(&P::margin_mm, "margin_mm", Range{5, 100}, "How much air is kept around the head.");
    v.number(&P::tissue_hu, "tissue_hu", Range{-700, 100}, "Lowest HU of skin and fat.");
  }
};

/// The stage's result; without a cranial cavity nothing of it is there.
struct HeadRegionResult {
  std::optional<double> cranial_cavity_ml, foramen_z_mm;
  /// Of each shape of a head that the scan's end or the field's edge cuts, where: "above", "below", "on its left side",
  /// "above and on its left and back side".
  Named<std::string> cut;
  std::optional<double> cavity_height_ratio, cavity_length_ratio;  ///< to its width; not of a cavity that is cut
  std::optional<double> region_ml;
  std::optional<bool> neck_cut;
  template <class V>
  static void describe(V& v) {
    using P = HeadRegionResult;
    v.number(&P::cranial_cavity_ml, "cranial_cavity_ml", "Volume of the cranial cavity.");
    v.number(&P::foramen_z_mm, "foramen_z_mm", "Level of the foramen magnum, LPS.");
    v.map(&P::cut, "cut", "Where the scan cuts a shape, by its name.").items_between("", "_cut").not_always();
    v.number(&P::cavity_height_ratio, "cavity_height_ratio",
             "The cranial cavity's height to its width, by its moments.");
    v.number(&P::cavity_length_ratio, "cavity_length_ratio",
             "The cranial cavity's length to its width, by its moments.");
    v.number(&P::region_ml, "region_ml", "Volume of the region.");
    v.flag(&P::neck_cut, "neck_cut", "Whether it is cut through the neck.");
  }
};

/// Cuts a scan to the region of the head, on the same voxels. The cranial cavity is found first, on cells of about 2 mm
/// (bone above 226 HU encloses it); its lower end is the lowest level at which it is wider than a foramen magnum. The
/// region reaches from below_mm under that level to the end of the tissue above it, and to the ends of the tissue in
/// between on all sides, each with margin_mm. Up is the volume's axis that is nearest to the patient's (LPS z).
///
/// Warnings say what the scan does not
/// show: the vertex or the base of the skull (the cavity reaches the volume's end), the skin of the vertex (tissue
/// reaches it), or a side of the head that the field of view cuts by more than 150 mm2, be it the volume's side or
/// padding (mask/field_edge.h), above the foramen magnum. Brain and dura are cut there, too, where the cavity, followed
/// by 16 mm to the field's edge as far as no bone lies between, has 300 mm2 at it. A cavity that is not cut and is
/// flatter, taller, longer or wider than heads are is said, as of slices, rows or columns whose distance is wrong.
/// Where no space enclosed by bone is found, the volume stays as it is and a warning says so. Throws Error 65 where a
/// voxel is not finite; Cancelled. The result has the same bits whatever the thread count.
Outcome<grid::HuVolume, HeadRegionResult> head_region(const grid::HuVolume& volume, const HeadRegionParams& params,
                                                      const Progress& progress = {});

}  // namespace trephine::head
