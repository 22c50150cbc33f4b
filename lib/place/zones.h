// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "mask/bits.h"
#include "place/place_head.h"

namespace trephine::place {

/// What of a head no tool should enter, as far as a CT alone says where it lies.
enum class Zone { dura, midline, sagittal_sinus, third_ventricle, brainstem };

struct ZoneParams {
  Zone what = Zone::sagittal_sinus;
  double thickness_mm = 0, inset_mm = 0;
  double half_width_mm = 2;
  double sinus_half_width_mm = 5, sinus_depth_mm = 8;
  double cell_mm = 0, smooth_mm = 0;
  double max_beyond_mm = 10;

  template <class V>
  static void describe(V& v) {
    using P = ZoneParams;
    v.choice(&P::what, "what",
             {{"dura", Zone::dura},
              {"midline", Zone::midline},
              {"sagittal_sinus", Zone::sagittal_sinus},
              {"third_ventricle", Zone::third_ventricle},
              {"brainstem", Zone::brainstem}},
             "Which zone: the dura at the inner table, a slab in the midsagittal plane, the superior sagittal sinus "
             "with its lacunae, the third ventricle, or the brainstem.");
    v.number(&P::thickness_mm, "thickness_mm", Range{0, 10},
             "dura: a shell of this thickness inside of the inner table; 0: all that the dura encloses, which in a "
             "haptic volume stands after brain and ventricles.");
    v.number(&P::inset_mm, "inset_mm", Range{0, 20},
             "dura: its surface lies so far inside of the inner table: a smooth brain where a scan shows none.");
    v.number(&P::half_width_mm, "half_width_mm", Range{0.2, 20},
             "midline: half of the slab's width; at least a voxel.");
    v.number(&P::sinus_half_width_mm, "sinus_half_width_mm", Range{1, 30},
             "sagittal_sinus: how far it and its lacunae reach to each side of the midline.");
    v.number(&P::sinus_depth_mm, "sinus_depth_mm", Range{1, 30}, "sagittal_sinus: how far below the inner table.");
    v.number(&P::cell_mm, "cell_mm", Range{0, 5},
             "dura and midline: they are found on cells of about this size, each a box of whole voxels; 0: on voxels. "
             "Coarse cells save time and triangles, and such a zone lies on no raster of the scan.");
    v.number(&P::smooth_mm, "smooth_mm", Range{0, 10},
             "dura: the standard deviation by which its surface is smoothed, so that it spans pits of the bone.");
    v.number(
        &P::max_beyond_mm, "max_beyond_mm", Range{0, 100},
        "dura: how far it may reach beyond a template's cranial cavity, where that is sure to fit. Thick slices "
        "lose the thin bone of the skull's base, and what lies behind it (orbits, sinuses, nose) is not dura's; 0: "
        "as far as the bone lets it.");
  }
};

/// What a zone is made from, on the scan's raster.
struct ZoneShapes {
  const grid::Field* skull = nullptr;       ///< may be null: then the cavity's surface is that of its voxels
  const grid::Field* ventricles = nullptr;  ///< third_ventricle needs it; others lie better with it
  const grid::HuVolume* volume =
      nullptr;  ///< may be null: then air is not taken off the dura, and no zone held against it
  /// Gives what place_in_cavity gives of this cavity and, unless it is to be without them, the ventricles, for callers
  /// who know it already. Empty: the template is registered here.
  std::function<HeadPlace(bool with_ventricles, const Progress& progress)> place = {};
};

/// What is printed of a zone; what was not looked for is missing.
struct ZoneResult {
  std::optional<double> cranial_cavity_ml;
  std::optional<double> beyond_ml;  ///< of the dura, cut off beyond the template's cavity
  std::optional<double> air_ml;     ///< of the dura, left out as air of sinuses and bone cells
  std::optional<PlaceFigures> place;
  std::optional<double> third_shift_mm;    ///< how far the third ventricle lies to the left of the midline
  std::optional<double> medulla_shift_mm;  ///< of the brainstem: of the medulla's end from the template's
  double volume_ml = 0;
  template <class V>
  static void describe(V& v) {
    using P = ZoneResult;
    v.number(&P::cranial_cavity_ml, "cranial_cavity_ml", "Volume of the cranial cavity.");
    v.number(&P::beyond_ml, "beyond_ml", "What was cut off beyond the template's cavity.");
    v.number(&P::air_ml, "air_ml", "Air of sinuses and bone cells that was left out.");
    v.all_of(&P::place);
    v.number(&P::third_shift_mm, "third_shift_mm", "How far the third ventricle lies to the left of the midline.");
    v.number(&P::medulla_shift_mm, "medulla_shift_mm", "How far the medulla's end lies beside the template's.");
    v.number(&P::volume_ml, "volume_ml", Range{}, "Volume of the zone.");
  }
};

/// Where the template lies by the cavity and, where they are given, the ventricles on the cavity's raster.
HeadPlace place_in_cavity(const mask::BitMask& cavity, const grid::Field* ventricles, const Progress& progress = {});

/// The zone as a field in mm (positive inside) on the part of the cavity's lattice, or of its cells, where it lies.
///
/// A template of a head is registered to the cranial cavity and to the ventricles (place_head.h); midline, sinus,
/// brainstem and the border between third and lateral ventricles are its. What a CT shows itself is taken from it: the
/// inner table (to a fraction of a voxel), the ventricles' walls. The sinus is the cavity's part under the vault within
/// sinus_half_width_mm of the midline and sinus_depth_mm of the inner table, from above the frontal sinuses to above
/// the inner occipital protuberance: larger than the vessel, which a plain CT does not show. The brainstem is the
/// template's, but for the medulla's end, which lies in the foramen magnum that the scan shows (brainstem.h). Of the
/// ventricles near the template's third one, what goes on from side to side beyond 9 mm of the midline is lateral;
/// where a mass or a bleed has moved the third one to the side, it is followed there (third_ventricle.h), and less than
/// 0.1 ml of it are none.
///
/// Of the dura, what reaches max_beyond_mm beyond the template's cavity is cut off, with a warning above
/// 3 ml, and so is the air of sinuses and bone cells at the skull's base, with their walls and what is left between
/// them (0.3 ml and more of what is darker than -60 HU, where some of it is below -300 HU).
/// What the scan holds against the zone is said as warnings (zone_doubts.h).
/// Throws Error 64 where a shell is thinner than two voxels
/// or the third ventricle has no ventricles; 65 where a field is on another raster; 80 where the template is not
/// sure to fit, where nothing of the zone lies in the scan, and where the cavity has less than 300 ml, as of a head
/// that the scan's field cuts in half. The same bits whatever the thread count.
Outcome<grid::Field, ZoneResult> find_zone(const mask::BitMask& cavity, const ZoneShapes& shapes,
                                           const ZoneParams& params, const Progress& progress = {});

}  // namespace trephine::place
