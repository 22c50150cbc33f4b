// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "lesson/rubric.h"

namespace trephine::lessons {

/// How a percutaneous needle in a pedicle is scored. The dissertation (chapter 8.2.1) measured the accuracy of entry
/// and target and the exposure, and states neither units nor limits: all of them are ours.
struct SpineNeedleRubric : lesson::LessonRubric {
  std::string module;
  lesson::FourLimits entry_mm, target_mm, breach_mm, depth_mm, exposure_s, passes_count, procedure_s;
  std::optional<lesson::FourLimits> insertion_mm_per_s;
  lesson::RubricLimit least_confidence_ratio, farthest_mm;
  template <class V>
  static void describe(V& v) {
    using P = SpineNeedleRubric;
    v.word(&P::module, "module", {"spine_needle"}, "The lesson that it scores.").is_required();
    v.group(&P::entry_mm, "entry_mm", "How far the needle passes from the ideal entry.").is_required();
    v.group(&P::target_mm, "target_mm", "How far its line passes from the target.").is_required();
    v.group(&P::breach_mm, "breach_mm", "How far it came through the pedicle's wall.").is_required();
    v.group(&P::depth_mm, "depth_mm", "How far the tip lies before or behind the target, along the axis.")
        .is_required();
    v.group(&P::exposure_s, "exposure_s", "How long X-rays were on.").is_required();
    v.group(&P::passes_count, "passes_count", "How often the needle entered bone.").is_required();
    v.group(&P::insertion_mm_per_s, "insertion_mm_per_s", "How fast the needle went into the patient: of its passes.");
    v.group(&P::procedure_s, "procedure_s", "Time to complete the procedure.").is_required();
    v.group(&P::least_confidence_ratio, "least_confidence_ratio",
            "A pedicle of less confidence is doubtful: what is measured from it is not judged.")
        .is_required();
    v.group(&P::farthest_mm, "farthest_mm", "A needle that enters bone farther from every pedicle's entry is at none.")
        .is_required();
    v.template all_of<lesson::LessonRubric>();
  }
  std::string fault() const {
    if (least_confidence_ratio.limit > 1) return "least_confidence_ratio.limit: is above 1";
    return LessonRubric::fault({"anterior_cortex_mm", "canal", "medial_breach_mm", "other_breach_mm", "beside_spine_mm",
                                "great_vessel", "wrong_side", "wrong_level"});
  }
};

}  // namespace trephine::lessons
