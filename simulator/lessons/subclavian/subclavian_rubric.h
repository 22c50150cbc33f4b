// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "lesson/rubric.h"

namespace trephine::lessons {

/// "Puncture of the skin": below the clavicle's lower border, straight under it in the frontal plane.
struct PunctureRubric {
  lesson::RubricLimit ideal_mm, far_mm;
  template <class V>
  static void describe(V& v) {
    using P = PunctureRubric;
    v.group(&P::ideal_mm, "ideal_mm", "Farthest below the border for a score of 5.").is_required();
    v.group(&P::far_mm, "far_mm", "The same for a score of 3; beyond it 2, and above the border 1.").is_required();
  }
  std::string fault() const;
};

/// "Direction of the needle": in the frontal plane, against the line from the puncture to the sternal notch.
struct NotchRubric {
  lesson::RubricLimit ideal_deg, good_deg, acceptable_deg;
  template <class V>
  static void describe(V& v) {
    using P = NotchRubric;
    v.group(&P::ideal_deg, "ideal_deg", "Largest angle for a score of 5.").is_required();
    v.group(&P::good_deg, "good_deg", "The same for a score of 4.").is_required();
    v.group(&P::acceptable_deg, "acceptable_deg", "The same for a score of 3; up to 90 degrees 2, beyond it 1.")
        .is_required();
  }
  std::string fault() const;
};

/// "Needle passes": how often the needle entered the skin.
struct PassesRubric {
  lesson::RubricLimit ideal_count, good_count, most_count;
  template <class V>
  static void describe(V& v) {
    using P = PassesRubric;
    v.group(&P::ideal_count, "ideal_count", "Most passes for a score of 5.").is_required();
    v.group(&P::good_count, "good_count", "The same for a score of 4.").is_required();
    v.group(&P::most_count, "most_count", "The same for a score of 3; more are a failure: 1.").is_required();
  }
  std::string fault() const;
};

/// The subclavian central line [Rizzi, chapter 7.3]. The rows vein, artery, and pleura and lung have no limits: blood
/// was drawn or not, a structure was entered or not.
struct SubclavianRubric : lesson::LessonRubric {
  std::string module;
  PunctureRubric puncture;
  NotchRubric direction;
  PassesRubric passes;
  lesson::TimeRubric time;
  std::optional<lesson::FourLimits> insertion_mm_per_s, aspirations_count, beyond_vein_mm;
  template <class V>
  static void describe(V& v) {
    using P = SubclavianRubric;
    v.word(&P::module, "module", {"subclavian"}, "The lesson that it scores.").is_required();
    v.group(&P::puncture, "puncture", "Puncture of the skin.").is_required();
    v.group(&P::direction, "direction", "Direction of the needle.").is_required();
    v.group(&P::passes, "passes", "Needle passes.").is_required();
    v.group(&P::time, "time", "Time to complete procedure; beyond the time allotted the needle is red.").is_required();
    v.group(&P::insertion_mm_per_s, "insertion_mm_per_s", "How fast the needle went into the patient: of its passes.");
    v.group(&P::aspirations_count, "aspirations_count", "How often somebody drew at the syringe: of the row vein.");
    v.group(&P::beyond_vein_mm, "beyond_vein_mm",
            "How far the needle came out of the vein again, ahead: of the row vein.");
    v.template all_of<lesson::LessonRubric>();
  }
  std::string fault() const { return LessonRubric::fault({"artery", "pleura_or_lung", "wrong_side"}); }
};

}  // namespace trephine::lessons
