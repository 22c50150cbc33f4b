// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "head/head_landmarks.h"
#include "mask/scan_figures.h"

namespace trephine::head {

/// The anatomies of one head as fields (positive inside) on one raster, each perhaps covering only a part of it. Null
/// where not known; what needs that anatomy is then neither measured nor checked.
struct HeadFields {
  const grid::Field* skin = nullptr;  ///< the whole head, filled
  const grid::Field* skull = nullptr;
  const grid::Field* brain = nullptr;  ///< includes the ventricles
  const grid::Field* ventricles = nullptr;
  const mask::ScanFigures* scan = nullptr;  ///< of the scan that they were made from
};

/// The class of a case, which follows from its ventricles; uncertain where they cannot be whole.
enum class HeadClass { unknown, normal, hydrocephalic, shifted, small, uncertain };
const char* to_text(HeadClass head_class);

struct HeadClassParams {
  double hydrocephalic_evans_ratio = 0.3;
  double shifted_mm = 5;
  double small_evans_ratio = 0.25;
  double small_ventricles_ratio = 0.012;
  double most_pieces_count = 4;
  double least_sides_ratio = 0.25;
  double least_horn_mm2 = 15;
  double least_horns_ratio = 0.3;
  double least_ventricles_ml = 3, most_ventricles_ml = 400;
  double least_evans_ratio = 0.12, most_evans_ratio = 0.75;
  double most_shift_mm = 25;
  double least_cube_noise_hu = 1.2, most_cube_noise_hu = 23, most_noise_hu = 80;
  double doubtful_evans_ratio = 0.04, doubtful_shift_mm = 2, doubtful_share_ratio = 0.3;

  template <class V>
  static void describe(V& v) {
    using P = HeadClassParams;
    v.number(&P::hydrocephalic_evans_ratio, "hydrocephalic_evans_ratio", Range{0, 1},
             "A case is hydrocephalic above this Evans' index.");
    v.number(&P::shifted_mm, "shifted_mm", Range{0, 50},
             "A case is shifted where the midline is off by more than this.");
    v.number(&P::small_evans_ratio, "small_evans_ratio", Range{0, 1},
             "A case is small only where Evans' index is not above this.");
    v.number(&P::small_ventricles_ratio, "small_ventricles_ratio", Range{0, 1},
             "A case is small only where the ventricles are below this share of the brain's volume.");
    v.number(&P::most_pieces_count, "most_pieces_count", Range{1, 1000},
             "The class is uncertain where the ventricles are in more pieces of 0.1 ml or more.");
    v.number(&P::least_sides_ratio, "least_sides_ratio", Range{0, 1},
             "The class is uncertain where one half of the ventricles has less than this share of the other's volume.");
    v.number(&P::least_horn_mm2, "least_horn_mm2", Range{0, 1000},
             "A frontal horn is a thread below this cross-section (median): the class is uncertain, Evans' index not "
             "given.");
    v.number(&P::least_horns_ratio, "least_horns_ratio", Range{0, 1},
             "A frontal horn is a thread below this share of the other one's cross-section, too.");
    v.number(&P::least_ventricles_ml, "least_ventricles_ml", Range{0, 1000},
             "The class is uncertain below this volume of the ventricles.");
    v.number(&P::most_ventricles_ml, "most_ventricles_ml", Range{0, 2000},
             "The class is uncertain above this volume of the ventricles.");
    v.number(&P::least_evans_ratio, "least_evans_ratio", Range{0, 1},
             "The class is uncertain below this Evans' index.");
    v.number(&P::most_evans_ratio, "most_evans_ratio", Range{0, 1}, "The class is uncertain above this Evans' index.");
    v.number(&P::most_shift_mm, "most_shift_mm", Range{0, 100}, "The class is uncertain above this midline shift.");
    v.number(&P::least_cube_noise_hu, "least_cube_noise_hu", Range{0, 1000},
             "The class is uncertain below this noise of the scan in a cube of 2 mm: no scanner has so little, so that "
             "horns may have been smoothed away with it.");
    v.number(&P::most_cube_noise_hu, "most_cube_noise_hu", Range{0, 1000},
             "The class is uncertain above this noise of the scan in a cube of 2 mm.");
    v.number(&P::most_noise_hu, "most_noise_hu", Range{0, 2000},
             "The class is uncertain above this noise of a voxel of the scan.");
    v.number(
        &P::doubtful_evans_ratio, "doubtful_evans_ratio", Range{0, 1},
        "In a scan that is doubtful for ventricles (thick slices, noise), the class is uncertain where Evans' index "
        "is this near to hydrocephalic_evans_ratio.");
    v.number(&P::doubtful_shift_mm, "doubtful_shift_mm", Range{0, 50},
             "In such a scan it is uncertain where the midline's shift is this near to shifted_mm.");
    v.number(&P::doubtful_share_ratio, "doubtful_share_ratio", Range{0, 1},
             "In such a scan it is uncertain where the ventricles' share of the brain's volume is so near to "
             "small_ventricles_ratio, as a share of that.");
  }
};

/// Figures of a head; a figure is empty where it could not be measured.
struct HeadFigures {
  /// Of the ventricles: pieces, the smaller side's share of the larger one's volume, the frontal horns' cross-sections.
  std::optional<std::int64_t> ventricle_pieces_count;
  std::optional<double> ventricle_sides_ratio, horn_left_mm2, horn_right_mm2;
  std::optional<double> skin_ml, skull_ml, brain_ml, ventricles_ml;
  /// The frontal horns' greatest width, measured in the axial plane of the head where it is greatest, and the inner
  /// skull's width in that plane. evans_place_mm is the centre of the frontal horns' width.
  std::optional<double> frontal_horns_mm, inner_skull_mm, evans_index_ratio;
  Vec3 evans_place_mm;
  /// How far a structure of the midline is shifted to the patient's left (to the right: below 0), at the foramina of
  /// Monro. midline_of names the structure: "septum" (halfway between the frontal horns' inner walls), "third
  /// ventricle", or "frontal horns" (their centre).
  std::optional<double> midline_shift_mm;
  std::string midline_of;
  Vec3 midline_place_mm;
  HeadClass head_class = HeadClass::unknown;
  template <class V>
  static void describe(V& v) {
    using P = HeadFigures;
    v.integer(&P::ventricle_pieces_count, "ventricle_pieces_count", "Pieces of the ventricles of 0.1 ml and more.");
    v.number(&P::ventricle_sides_ratio, "ventricle_sides_ratio", "The smaller half's share of the larger one.");
    v.number(&P::horn_left_mm2, "horn_left_mm2", "Cross-section of the left frontal horn.");
    v.number(&P::horn_right_mm2, "horn_right_mm2", "Cross-section of the right frontal horn.");
    v.number(&P::skin_ml, "skin_ml", "What the skin encloses.");
    v.number(&P::skull_ml, "skull_ml", "Volume of the skull.");
    v.number(&P::brain_ml, "brain_ml", "Volume of the brain.");
    v.number(&P::ventricles_ml, "ventricles_ml", "Volume of the ventricles.");
    v.number(&P::frontal_horns_mm, "frontal_horns_mm", "The frontal horns' greatest width.");
    v.number(&P::inner_skull_mm, "inner_skull_mm", "The inner skull's width in that plane.");
    v.number(&P::evans_index_ratio, "evans_index_ratio", "Evans' index.");
    v.number(&P::midline_shift_mm, "midline_shift_mm", "Shift of the midline to the patient's left.");
    v.text(&P::midline_of, "midline_of", "The structure that it was measured of.").not_always();
    v.choice(&P::head_class, "class",
             {{"normal", HeadClass::normal},
              {"hydrocephalic", HeadClass::hydrocephalic},
              {"shifted", HeadClass::shifted},
              {"small", HeadClass::small},
              {"uncertain", HeadClass::uncertain},
              {"unknown", HeadClass::unknown}},
             "The head's class.");
  }
};

/// The place of an anatomy's volume in the figures, measured or not; null for an anatomy that they do not know.
std::optional<double>* volume_of(HeadFigures& figures, const std::string& anatomy);

/// Measures a head in its own axes: left is the midsagittal plane's normal, up is the patient's superior direction,
/// made perpendicular to left.
/// - Volumes count voxels whose centre is inside.
/// - Evans' index [Evans1942]: above 0.3 the ventricles are enlarged [Relkin2005]. The frontal horns are the part of
///   the ventricles in front of the foramina of Monro that is connected with their foremost point.
/// - Midline shift: the limit is 5 mm [Bullock2006]. Where `landmarks` is null or its plane has no confidence, the
///   middle is halfway between the two sides of the inner skull at that place (the shift is half of the intracranial
///   width less the septum's distance from the inner table).
/// - Small: there is no agreed limit. The class says that a catheter has little to aim at, not that a person is ill.
///   Our limit is below 1.2 % of the brain's volume with an index of at most 0.25, the upper end of what Evans found in
///   healthy people (0.20 to 0.25). 38 people without pathology had 17.4 ml on average in all four ventricles
///   [VentricularVolume], about 1.4 % of a brain of 1,250 ml, so the smaller ventricles of healthy people are small
///   here. The synthetic head's small ventricles hold 5 to 11 ml, its normal ones about 21. Where several classes
///   apply, the first of this list is given: uncertain, shifted, hydrocephalic, small, normal. The class is unknown
///   where the ventricles or what bounds them are missing.
///
/// - Uncertain: the ventricles cannot be whole, or the scan does not show whether they are (head_doubts.h); each reason
///   is a warning. Where a frontal horn is
/// missing
///   or a thread, frontal_horns_mm and evans_index_ratio are empty: the width would be measured across the gap.
///
/// A landmark monro_left or monro_right that has a confidence is used. Without it the foramina are taken to lie behind
/// the foremost point of the ventricles by 0.31 of the lateral ventricles' length, at most 32 mm.
///
/// Warnings name what could not be measured. Throws Error 65 where a voxel is
/// not finite or the rasters differ; Cancelled. The result has the same bits whatever the thread count.
Outcome<std::monostate, HeadFigures> measure_head(const HeadFields& fields, const HeadLandmarks* landmarks,
                                                  const HeadClassParams& params, const Progress& progress = {});

}  // namespace trephine::head
