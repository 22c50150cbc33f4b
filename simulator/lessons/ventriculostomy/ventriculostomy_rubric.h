// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "lesson/rubric.h"

namespace trephine::lessons {

/// "Anatomy and landmarks", judged from the marker's traces. Each of midline and suture counts twice where it was
/// found, once where it was nearly found; the score is 1 and their sum.
struct LandmarksRubric {
  lesson::RubricLimit midline_mm, midline_near_mm, midline_trace_mm, suture_mm, suture_near_mm, suture_trace_mm;
  template <class V>
  static void describe(V& v) {
    using P = LandmarksRubric;
    v.group(&P::midline_mm, "midline_mm", "Farthest from the midline that a trace along it may lie.").is_required();
    v.group(&P::midline_near_mm, "midline_near_mm", "The same for a midline that was nearly found.").is_required();
    v.group(&P::midline_trace_mm, "midline_trace_mm", "Shortest trace that shows the midline.").is_required();
    v.group(&P::suture_mm, "suture_mm", "Farthest from the suture that a trace along it may lie.").is_required();
    v.group(&P::suture_near_mm, "suture_near_mm", "The same for a suture that was nearly found.").is_required();
    v.group(&P::suture_trace_mm, "suture_trace_mm", "Shortest trace that shows the suture.").is_required();
  }
  std::string fault() const;
};

/// "Burr hole placement".
struct BurrHoleRubric {
  lesson::RubricLimit kocher_mm, near_mm, far_mm, midline_mm, least_confidence_ratio;
  template <class V>
  static void describe(V& v) {
    using P = BurrHoleRubric;
    v.group(&P::kocher_mm, "kocher_mm", "Farthest from Kocher's point for a score of 5.").is_required();
    v.group(&P::near_mm, "near_mm", "The same for a score of 4.").is_required();
    v.group(&P::far_mm, "far_mm", "The same for a score of 3.").is_required();
    v.group(&P::midline_mm, "midline_mm", "A hole whose middle is this near to the midline lies along it: 1.")
        .is_required();
    v.group(&P::least_confidence_ratio, "least_confidence_ratio",
            "Suture and nasion of less confidence are doubtful: what is measured from them is not judged.")
        .is_required();
  }
  std::string fault() const;
};

/// "Trajectory of catheter insertion": how far the catheter's line passes from the foramen, and what it passed through.
struct TrajectoryRubric {
  lesson::RubricLimit ideal_mm, good_mm, lateral_mm, midline_mm;
  template <class V>
  static void describe(V& v) {
    using P = TrajectoryRubric;
    v.group(&P::ideal_mm, "ideal_mm", "Farthest that the line may pass from the foramen for a score of 5.")
        .is_required();
    v.group(&P::good_mm, "good_mm", "The same for a score of 4.").is_required();
    v.group(&P::lateral_mm, "lateral_mm", "The same for a score of 3; beyond it 2.").is_required();
    v.group(&P::midline_mm, "midline_mm", "How far a tip may come on the other side before it traversed the midline.")
        .is_required();
  }
  std::string fault() const;
};

/// What no catheter may pass through. Where the case has no shape or zone of a structure, these distances say where it
/// is.
struct CriticalRubric {
  lesson::RubricLimit sinus_mm, third_ventricle_mm, third_ventricle_below_mm, brainstem_mm, brainstem_below_mm;
  template <class V>
  static void describe(V& v) {
    using P = CriticalRubric;
    v.group(&P::sinus_mm, "sinus_mm", "A catheter that enters the brain this near to the midline passes the sinus.")
        .is_required();
    v.group(&P::third_ventricle_mm, "third_ventricle_mm", "Liquor this near to the midline is the third ventricle ...")
        .is_required();
    v.group(&P::third_ventricle_below_mm, "third_ventricle_below_mm", "... so far below the foramina.").is_required();
    v.group(&P::brainstem_mm, "brainstem_mm", "What lies this near to the midline is the brainstem ...").is_required();
    v.group(&P::brainstem_below_mm, "brainstem_below_mm", "... so far below the foramina.").is_required();
  }
};

/// "Depth of catheter insertion".
struct DepthRubric {
  enum class From { inner_table, outer_table };
  From measured_from = From::inner_table;
  lesson::RubricLimit least_mm, low_mm, ideal_low_mm, ideal_high_mm, high_mm, most_mm;
  template <class V>
  static void describe(V& v) {
    using P = DepthRubric;
    v.choice(&P::measured_from, "measured_from",
             {{"inner_table", From::inner_table}, {"outer_table", From::outer_table}},
             "The table of the bone from which the depth is measured, along the catheter.")
        .is_required();
    v.group(&P::least_mm, "least_mm", "Less than this scores 1.").is_required();
    v.group(&P::low_mm, "low_mm", "Less than this scores 2.").is_required();
    v.group(&P::ideal_low_mm, "ideal_low_mm", "Less than this scores 3.").is_required();
    v.group(&P::ideal_high_mm, "ideal_high_mm", "Up to this scores 5.").is_required();
    v.group(&P::high_mm, "high_mm", "Up to this scores 3.").is_required();
    v.group(&P::most_mm, "most_mm", "Up to this scores 2, beyond it 1.").is_required();
  }
  std::string fault() const;
};

/// "Final location of catheter tip". missed_mm is of rubrics of version 1, and nothing is judged by it any more: Table
/// XIII scores 1 wherever the tip is in no ventricle.
struct TipRubric {
  lesson::RubricLimit foramen_mm, near_mm, least_confidence_ratio;
  std::optional<lesson::RubricLimit> missed_mm;
  template <class V>
  static void describe(V& v) {
    using P = TipRubric;
    v.group(&P::foramen_mm, "foramen_mm", "Farthest from the foramen of the hole's side for a score of 5.")
        .is_required();
    v.group(&P::near_mm, "near_mm", "The same for a score of 4.").is_required();
    v.group(&P::least_confidence_ratio, "least_confidence_ratio",
            "A foramen of less confidence is doubtful: what is measured from it is not judged.")
        .is_required();
    v.group(&P::missed_mm, "missed_mm", "Of rubrics of version 1: nothing is judged by it.");
  }
  std::string fault() const;
};

/// Table XIII of the dissertation.
struct VentriculostomyRubric : lesson::LessonRubric {
  std::string module;
  LandmarksRubric landmarks;
  BurrHoleRubric burr_hole;
  TrajectoryRubric trajectory;
  CriticalRubric critical;
  DepthRubric depth;
  TipRubric tip;
  lesson::TimeRubric time;
  std::optional<lesson::FourLimits> passes, insertion_mm_per_s;
  template <class V>
  static void describe(V& v) {
    using P = VentriculostomyRubric;
    v.word(&P::module, "module", {"ventriculostomy"}, "The lesson that it scores.").is_required();
    v.group(&P::landmarks, "landmarks", "Anatomy and landmarks.").is_required();
    v.group(&P::burr_hole, "burr_hole", "Burr hole placement.").is_required();
    v.group(&P::trajectory, "trajectory", "Trajectory of catheter insertion.").is_required();
    v.group(&P::critical, "critical", "Critical structures.").is_required();
    v.group(&P::depth, "depth", "Depth of catheter insertion.").is_required();
    v.group(&P::tip, "tip", "Final location of catheter tip.").is_required();
    v.group(&P::time, "time", "Time to complete procedure.").is_required();
    v.group(&P::passes, "passes",
            "How often the catheter entered the brain, with holes and incisions beyond one: ours, beside the table.");
    v.group(&P::insertion_mm_per_s, "insertion_mm_per_s", "How fast a tool went into the patient, beside the table.");
    v.template all_of<lesson::LessonRubric>();
  }
  std::string fault() const {
    for (const lesson::Question& q : questions)
      if (q.when == "dry_catheter")
        return "questions: " + q.question + ": when: dry_catheter is known only when the lesson is finished";
    return LessonRubric::fault(
        {"dura_by_burr", "sagittal_sinus", "brainstem", "eloquent_zone", "wrong_side", "dry_catheter"});
  }
};

}  // namespace trephine::lessons
