// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What of a head's scan a person should look at before its case is used. It is measured, and nothing is diagnosed.
#include <string>
#include <utility>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "grid/labels.h"
#include "head/head_landmarks.h"
#include "mask/bits.h"

namespace trephine::findings {

struct FindingsParams {
  double blood_hu = 48, most_blood_hu = 100, min_blood_ml = 1.5;
  double dark_hu = 20, min_dark_ml = 5;
  double min_shift_mm = 3;
  double wide_evans_ratio = 0.3;
  double min_gap_cm2 = 0.6;
  double metal_hu = 2500, tube_hu = 110, min_tube_mm = 25;

  template <class V>
  static void describe(V& v) {
    using P = FindingsParams;
    v.number(&P::blood_hu, "blood_hu", Range{32, 90},
             "From this on soft tissue inside the skull is as dense as fresh blood, where brain has 30 HU.");
    v.number(&P::most_blood_hu, "most_blood_hu", Range{50, 200},
             "What is denser than this is no blood: calcification, contrast medium, metal.");
    v.number(&P::min_blood_ml, "min_blood_ml", Range{0.2, 100}, "Less of it is not reported.");
    v.number(&P::dark_hu, "dark_hu", Range{8, 29},
             "Below this brain tissue is dark (oedema, an old infarct, a cyst), where brain has 30 HU.");
    v.number(&P::min_dark_ml, "min_dark_ml", Range{0.5, 500}, "Less of it is not reported.");
    v.number(&P::min_shift_mm, "min_shift_mm", Range{0.5, 50}, "A smaller shift of the midline is not reported.");
    v.number(&P::wide_evans_ratio, "wide_evans_ratio", Range{0.1, 1},
             "Ventricles of a larger Evans' index are reported as wide.");
    v.number(&P::min_gap_cm2, "min_gap_cm2", Range{0.2, 400},
             "A smaller gap in the bone of the vault is not reported.");
    v.number(&P::metal_hu, "metal_hu", Range{1500, 30000}, "From this on something is metal.");
    v.number(&P::tube_hu, "tube_hu", Range{60, 2000},
             "A tube inside the brain is denser than this, and than brain by three times the scan's noise.");
    v.number(&P::min_tube_mm, "min_tube_mm", Range{5, 200}, "A shorter one is not reported.");
  }
  std::string fault() const { return blood_hu >= most_blood_hu ? "blood_hu: is not below most_blood_hu" : ""; }
};

/// Below this confidence a finding may be something usual: a sinus, streaks, contrast medium.
constexpr double sure_confidence = 0.5;

enum class FindingKind { dense, dark, shift, wide_ventricles, bone_gap, metal, tube };
const char* to_text(FindingKind kind);
/// Whether a finding of that kind, as to_text calls it, is seen in the window of bone and not in that of brain.
bool is_seen_in_bone(const std::string& kind);
/// The sentence of a finding of that kind with its side behind it, where it has one.
std::string with_side(const std::string& text, const std::string& kind, const std::string& side);

/// One thing to look at.
struct Finding {
  FindingKind kind = FindingKind::dense;
  std::string where;                  ///< "in the ventricles", "in the brain", "beside the brain", "in the vault", ...
  std::string side;                   ///< left, right or middle; of the patient
  Vec3 position_mm;                   ///< its middle, LPS
  double confidence = 0;              ///< 0 to 1; sure from sure_confidence on
  std::vector<std::string> concerns;  ///< brain, ventricles, skull: what may be wrong because of it
  std::string text;                   ///< a whole sentence
  Named<ParameterValue> figures;      ///< volume_ml, longest_mm, mean_hu, area_cm2, shift_mm, ...
  template <class V>
  static void describe(V& v) {
    using P = Finding;
    v.choice(&P::kind, "kind",
             {{"dense_tissue", FindingKind::dense},
              {"dark_tissue", FindingKind::dark},
              {"midline_shift", FindingKind::shift},
              {"wide_ventricles", FindingKind::wide_ventricles},
              {"bone_gap", FindingKind::bone_gap},
              {"metal", FindingKind::metal},
              {"tube", FindingKind::tube}},
             "What it is.");
    v.text(&P::where, "where", "Where it lies, in words.");
    v.text(&P::side, "side", "The patient's side.");
    v.numbers(&P::position_mm, "position_mm", Range{}, "Its middle, LPS.");
    v.number(&P::confidence, "confidence", Range{}, "How sure it is that it is nothing usual.");
    v.words(&P::concerns, "concerns", "The anatomies that may be wrong because of it.");
    v.text(&P::text, "text", "A sentence that says it.");
    v.map(&P::figures, "figures", "What was measured.").items_alone();
  }
};

/// The shapes of the head, on the scan's raster.
struct FindingShapes {
  const grid::Field* skull = nullptr;              ///< required
  const grid::Field* brain = nullptr;              ///< required
  const grid::Field* ventricles = nullptr;         ///< may be null
  const head::HeadLandmarks* landmarks = nullptr;  ///< may be null: then sides are those of the scan's axes
  const mask::BitMask* cavity = nullptr;  ///< the cranial cavity on the volume's raster; null: it is looked for
  double voxel_noise_hu = 0;              ///< of the scan, as measure_scan has it; 0: not known
};

/// The stage's result.
struct FindingsResult {
  bool template_sure = false;  ///< the place of the template, by which sinuses are told
  double tissue_noise_hu = 0;  ///< of the brain's tissue, smoothed
  double contrast_ml = 0;      ///< what is as bright as vessels with contrast medium
  std::vector<Finding> list;   ///< the largest of each kind first, kinds in their order
  std::size_t findings_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = FindingsResult;
    v.choice(&P::template_sure, "template_sure", {{"no", false}, {"yes", true}}, "Whether the template lies surely.");
    v.number(&P::tissue_noise_hu, "tissue_noise_hu", Range{}, "Noise of the brain's tissue, smoothed.");
    v.number(&P::contrast_ml, "contrast_ml", Range{}, "What is as bright as vessels with contrast medium.");
    v.list(&P::list, "list", "What to look at.").items_alone();
    v.integer(&P::findings_count, "findings_count", Range{}, "How many there are.");
  }
};

/// Voxels of about 1.5 mm: n in the voxels of list[n - 1]; shift, width and gap have none.
using Findings = Outcome<grid::LabelFile, FindingsResult>;

/// Looks for what speaks against a usual head:
/// - dense: tissue inside the skull, not thinner than 3 mm, that is as dense as fresh blood (the brain's tissue
///   levelled to 30 HU). Where sinuses and the tentorium lie (a template's places), near the base and along the falx it
///   is not looked for. In the ventricles, beside the brain (half of it lies within 8 mm of the inner table), or in the
///   brain.
///   Its confidence is below 0.5 where vessels are as bright as contrast medium makes them, where it keeps to a few
///   slices (but for a level of blood in the ventricles that is 20 mm and 4 slices high), and where the tissue jumps
///   from slice to slice more than elsewhere in the scan, as streaks do.
/// - dark: tissue of the brain, not thinner than 7 mm, that is darker than white matter, away from ventricles, cisterns
///   and fissures.
///   So is air of 1 ml and more inside the skull (without a mean_hu), where the template lies surely: deep in the head,
///   or at its vault. At the base and in front it may be a sinus.
/// - shift: of the midline at the foramina of Monro; doubtful where the ventricles cannot be whole and no septum is
/// seen; wide_ventricles: by Evans' index (head/head_figures.h).
/// - bone_gap: rays from the brain through the vault that meet no bone before they leave the skin; the area at
///   the skull. In thick slices it is sure where it is several slices wide, or a round hole wider than a slice. Of the
///   occipital bone between inion and foramen magnum, where the head fits the template, rays from the cerebellum; the
///   area at the brain, which is smaller.
///   So is a round place of 0.3 to 3 cm2 where the vault's outer table lies 1.8 mm or more below that around it (then
///   there is a depth_mm), and the bone is thinner, but closed: a burr hole over which bone has grown. It is looked for
///   where the template lies surely.
/// - metal: above the base of the skull, within 25 mm of the brain. Pieces that are hardly denser than the vault's
///   densest bone (1.3 times; 1.7 times at the petrous bones) are one doubtful finding of their own.
/// - tube: straight, thin and long, in the brain; doubtful where it keeps to a few slices, as streaks of metal do.
///
/// Warns of each that is sure, and of how many of each kind are doubtful. The same bits whatever the thread count.
/// Throws Error 64 without skull or brain, 65 where a field is on another raster, 80 where the brain is empty;
/// Cancelled.
Findings find_findings(const grid::HuVolume& volume, const FindingShapes& shapes, const FindingsParams& params,
                       const Progress& progress = {});

}  // namespace trephine::findings
