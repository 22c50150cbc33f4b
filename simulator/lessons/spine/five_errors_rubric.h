// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "lesson/rubric.h"

namespace trephine::lessons {

/// The five errors of what lies in a pedicle, a screw or the finder before it, and how many are acceptable [Rizzi,
/// chapter 8.2.2]. The dissertation names the errors and says 2; from where on each is one it does not say.
struct FiveErrorsRubric : lesson::LessonRubric {
  lesson::RubricLimit entry_mm, axial_deg, sagittal_deg, length_mm, breach_mm, most_errors_count,
      least_confidence_ratio, farthest_mm;
  std::optional<lesson::RubricLimit> head_mm, widest_ratio, narrowest_ratio;
  std::optional<lesson::RubricLimit> proud_mm, finder_ratio;
  std::optional<lesson::FourLimits> exposure_s, passes_count, insertion_mm_per_s, procedure_s;
  template <class V>
  static void describe(V& v) {
    using P = FiveErrorsRubric;
    v.group(&P::entry_mm, "entry_mm", "Farther from the ideal entry, in the coronal plane, is an error.").is_required();
    v.group(&P::axial_deg, "axial_deg", "More off the ideal axis in the axial plane is an error.").is_required();
    v.group(&P::sagittal_deg, "sagittal_deg", "The same in the sagittal plane.").is_required();
    v.group(&P::length_mm, "length_mm", "A tip farther before or beyond the target is an error of length.")
        .is_required();
    v.group(&P::breach_mm, "breach_mm", "Farther through the pedicle's wall is an error.").is_required();
    v.group(&P::most_errors_count, "most_errors_count", "A screw with more errors is not acceptable.").is_required();
    v.group(&P::least_confidence_ratio, "least_confidence_ratio",
            "A pedicle of less confidence is doubtful: what is measured from it is not judged.")
        .is_required();
    v.group(&P::farthest_mm, "farthest_mm", "A screw that enters farther from every pedicle's entry is at none.")
        .is_required();
    v.group(&P::head_mm, "head_mm", "A head farther out of the bone, or deeper in it, is a wrong length of the screw.");
    v.group(&P::proud_mm, "proud_mm", "With a head that stands farther out of the bone nothing is completed.");
    v.group(&P::widest_ratio, "widest_ratio", "A screw wider than this share of the pedicle's width is too wide.");
    v.group(&P::narrowest_ratio, "narrowest_ratio", "One narrower than this share of it is too narrow.");
    v.group(&P::exposure_s, "exposure_s", "How long X-rays were on.");
    v.group(&P::passes_count, "passes_count", "How often a tool entered bone: the finder, and then the screw.");
    v.group(&P::insertion_mm_per_s, "insertion_mm_per_s", "How fast a tool went into the patient: of the passes.");
    v.group(&P::finder_ratio, "finder_ratio",
            "How deep a finder must have gone before the screw, as a share of the screw's depth: of the passes.");
    v.group(&P::procedure_s, "procedure_s", "Time to complete the procedure.");
    v.template all_of<lesson::LessonRubric>();
  }
  std::string fault() const {
    if (least_confidence_ratio.limit > 1) return "least_confidence_ratio.limit: is above 1";
    return LessonRubric::fault({"anterior_cortex_mm", "canal", "medial_breach_mm", "other_breach_mm", "beside_spine_mm",
                                "great_vessel", "wrong_side", "wrong_level"});
  }
};

}  // namespace trephine::lessons
