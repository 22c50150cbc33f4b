// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "head/head_landmarks.h"
#include "mask/scan_figures.h"

namespace trephine::head {

struct LandmarkParams {
  double along_mm = 110;
  double lateral_mm = 27.5;
  double bregma_mm = 125;

  template <class V>
  static void describe(V& v) {
    using P = LandmarkParams;
    v.number(&P::along_mm, "along_mm", Range{10, 250},
             "Kocher's points: distance from the nasion, along the midline over the skin.");
    v.number(&P::lateral_mm, "lateral_mm", Range{0, 100}, "Kocher's points: distance to the side, over the skin.");
    v.number(&P::bregma_mm, "bregma_mm", Range{80, 180},
             "Where the coronal suture is not clear: its usual distance from the nasion, over the midline's skin.");
  }
};

/// The fields (positive inside) from which the landmarks are found, on the volume's raster, perhaps covering only a
/// part of it.
struct LandmarkInputs {
  const grid::Field* skin = nullptr;        ///< required
  const grid::Field* skull = nullptr;       ///< required
  const grid::Field* brain = nullptr;       ///< may be null
  const grid::Field* ventricles = nullptr;  ///< may be null: then the foramina of Monro are not found
  const grid::HuVolume* as_read = nullptr;  ///< the scan before anything was taken off it; may be null
  std::vector<cases::CaseLandmark>
      given;  ///< given by a person; they replace found ones, others are measured from them
  /// Gives what measure_scan says of the volume, for callers who know it already; empty: it is measured here.
  std::function<mask::ScanFigures(const Progress& progress)> scan_figures;
};

/// How well the head is symmetric.
struct SymmetryFigures {
  double residual_mm = 0, midline_residual_mm = 0, matched_ratio = 0, sharpness_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = SymmetryFigures;
    v.number(&P::residual_mm, "symmetry_residual_mm", Range{}, "Of skull and skin from their mirror image.");
    v.number(&P::midline_residual_mm, "symmetry_midline_residual_mm", Range{}, "Of the structures on the midline.");
    v.number(&P::matched_ratio, "symmetry_matched_ratio", Range{}, "Share that matches.");
    v.number(&P::sharpness_mm, "symmetry_sharpness_mm", Range{}, "How much worse a plane beside it is.");
  }
};
/// The coronal suture where one is seen.
struct SutureFigures {
  double visible_ratio = 0, distinct_ratio = 0, halves_apart_mm = 0, from_nasion_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = SutureFigures;
    v.number(&P::visible_ratio, "suture_visible_ratio", Range{}, "Share of the suture that is seen.");
    v.number(&P::distinct_ratio, "suture_distinct_ratio", Range{}, "How much it stands out.");
    v.number(&P::halves_apart_mm, "suture_halves_apart_mm", Range{}, "How far its two halves lie apart.");
    v.number(&P::from_nasion_mm, "suture_from_nasion_mm", Range{}, "From the nasion, over the midline's skin.");
  }
};
struct LandmarkFigures {
  std::string position_mm;  ///< as a person reads it
  double confidence = 0;
  template <class V>
  static void describe(V& v) {
    v.text(&LandmarkFigures::position_mm, "mm", "Where it lies, LPS.");
    v.number(&LandmarkFigures::confidence, "confidence", Range{}, "How sure it is, 0 to 1.");
  }
};
/// What is printed of landmarks; what was not looked at is missing.
struct LandmarksResult {
  std::string midsagittal_from;             ///< "symmetry", or "given landmarks"
  std::optional<SymmetryFigures> symmetry;  ///< where the plane is from that
  std::optional<double> tragi_asymmetry_mm;
  Named<double> covered_ratio;  ///< of the skin about a tragus
  std::optional<double> vertex_to_highest_mm, vertex_to_half_way_mm;
  std::optional<double> midline_leap_mm;
  std::optional<SutureFigures> suture;
  std::optional<double> suture_near_midline_ratio;  ///< where it is clear
  Named<double> before_suture_mm;                   ///< how far a Kocher's point lies before it
  double midsagittal_confidence = 0;
  Named<LandmarkFigures> landmarks;
  template <class V>
  static void describe(V& v) {
    using P = LandmarksResult;
    v.text(&P::midsagittal_from, "midsagittal_from", "What the midsagittal plane is from.");
    v.all_of(&P::symmetry);
    v.number(&P::tragi_asymmetry_mm, "tragi_asymmetry_mm", "From one tragus to the other's mirror image.");
    v.map(&P::covered_ratio, "covered", "Share of the skin about it that something lay on.")
        .items_between("", "_covered_ratio");
    v.number(&P::vertex_to_highest_mm, "vertex_to_highest_mm", "From the vertex to the highest point as scanned.");
    v.number(&P::vertex_to_half_way_mm, "vertex_to_half_way_mm", "To half of the way from nasion to inion.");
    v.number(&P::midline_leap_mm, "midline_leap_mm", "The widest leap of the midline's skin.");
    v.all_of(&P::suture);
    v.number(&P::suture_near_midline_ratio, "suture_near_midline_ratio", "Share that is seen near the midline.");
    v.map(&P::before_suture_mm, "before_suture", "How far it lies before the coronal suture.")
        .items_between("", "_before_suture_mm");
    v.number(&P::midsagittal_confidence, "midsagittal_confidence", Range{}, "How sure the plane is, 0 to 1.");
    v.map(&P::landmarks, "landmarks", "Each landmark.").items_joined("_");
  }
};

/// Finds the landmarks of a head that is tilted by at most about 20 degrees (LPS axes), whole or cut. How each is
/// found, and how its confidence (0 to 1; reliable from 0.5 on) is computed, is in docs/reference/landmarks.md.
/// - midsagittal plane: mirror symmetry of skull and skin, then of the structures on the midline; from nasion, inion
///   (or vertex) and tragi where those are given
/// - nasion: the point of greatest concavity of the midline skin between brow and nose
/// - inion: the skin straight behind the point of the occiput that stands out most in the midline
/// - tragus_left, tragus_right: the rim in front of the concha
/// - vertex: the highest midline skin, with the line from the tragi to the nasion rising by 20 degrees
/// - bregma: where the coronal suture crosses the midline of the outer table (craniometry/coronal_suture.h), source
///   "found"; where it is not clear, only if it lies within 10 mm of the usual place; else that place, `bregma_mm` from
///   the nasion over the skin, source "estimated", with less than 0.5
/// - kocher_left, kocher_right: `along_mm` from the nasion over the midline of the skin, `lateral_mm` to the side, as
///   place_burr_hole measures them, to about 0.3 mm
/// - monro_left, monro_right: the narrowest place between the lateral ventricle and the third
///
/// They are then judged together: one that lies at an impossible distance from the others (craniometry/plausible.h),
/// far from bone, or beyond a leap of the midline's skin gets a confidence below 0.5, and a Kocher's point so does that
/// does not lie 5 to 25 mm before a suture that is seen. Of each one below 0.5 a warning tells why.
///
/// A landmark that lies outside the scan or cannot be seen (no face), or has a confidence below 0.05, is left out, and
/// warnings say so; nothing is invented. Given landmarks are in the result unchanged, with a warning for a
/// name that is not searched for (and the nearest name that is). The result has the same bits whatever the thread
/// count, and the function is safe to call from several threads.
///
/// Throws Error 64 without skin or skull; 65 where a field is on another raster, or where a given landmark is not
/// finite, occurs twice, or lies more than 30 mm outside of the skin; 80 where the volume has only one value, or there
/// is no skull or none that is symmetric while the plane is not given; Cancelled.
Outcome<HeadLandmarks, LandmarksResult> find_landmarks(const grid::HuVolume& volume, const LandmarkInputs& inputs,
                                                       const LandmarkParams& params, const Progress& progress = {});

/// `found`, with those of `given` in place of the ones of the same name, and the others after them. The plane and
/// Kocher's points stay as they were; find_landmarks with `given` measures them again.
HeadLandmarks merged(const HeadLandmarks& found, const std::vector<cases::CaseLandmark>& given);

}  // namespace trephine::head
