// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Lessons in the phantom of lessons_phantom.h, done through the servo and scored.
#include "lessons/ventriculostomy/ventriculostomy_score.h"
#include "lessons_phantom.h"
#include "lessons_run.h"

namespace lesson_cases {

class Head : public LessonCase {
 public:
  explicit Head(Kind kind, double suture_confidence = 1, bool dura = false)
      : LessonCase(head_case(kind, suture_confidence, dura)) {}
  using Done = Scored<lessons::VentriculostomyFacts>;
  Done run(const std::string& steps, double rate_hz = 500, std::int64_t seed = 1, double noise_mm = 0,
           const std::string& task = "") {
    Done d;
    d.recording = record("ventriculostomy", steps, {rate_hz, noise_mm, seed, task});
    score(d);
    return d;
  }
  void score(Done& d) {
    d.facts = facts_of<lessons::VentriculostomyFacts>(d.recording);
    d.score = lessons::score_ventriculostomy(d.facts, felt().loaded.manifest, whole(), rubric());
  }

  /// Limits of the shipped rubric, as configs/rubrics/ventriculostomy.yaml has them: the test's own reading of it.
  static lessons::VentriculostomyRubric rubric();
};

inline lessons::VentriculostomyRubric Head::rubric() {
  lessons::VentriculostomyRubric r;
  r.module = "ventriculostomy";
  is(r.landmarks.midline_mm, 5), is(r.landmarks.midline_near_mm, 10), is(r.landmarks.midline_trace_mm, 80);
  is(r.landmarks.suture_mm, 5), is(r.landmarks.suture_near_mm, 10), is(r.landmarks.suture_trace_mm, 10);
  is(r.burr_hole.kocher_mm, 10), is(r.burr_hole.near_mm, 15), is(r.burr_hole.far_mm, 30);
  is(r.burr_hole.midline_mm, 10), is(r.burr_hole.least_confidence_ratio, 0.5);
  is(r.trajectory.ideal_mm, 5), is(r.trajectory.good_mm, 10), is(r.trajectory.lateral_mm, 20);
  is(r.trajectory.midline_mm, 1);
  is(r.critical.sinus_mm, 6), is(r.critical.third_ventricle_mm, 4), is(r.critical.third_ventricle_below_mm, 3);
  is(r.critical.brainstem_mm, 15), is(r.critical.brainstem_below_mm, 25);
  is(r.depth.least_mm, 30), is(r.depth.low_mm, 40), is(r.depth.ideal_low_mm, 50);
  is(r.depth.ideal_high_mm, 60), is(r.depth.high_mm, 70), is(r.depth.most_mm, 90);
  is(r.tip.foramen_mm, 5), is(r.tip.near_mm, 10), is(r.tip.least_confidence_ratio, 0.5);
  is(r.time.ideal_s, 300), is(r.time.good_s, 450), is(r.time.acceptable_s, 600), is(r.time.allotted_s, 900);
  are(r.passes.emplace(), 1, 2, 3, 5), are(r.insertion_mm_per_s.emplace(), 100, 150, 250, 350);
  lists(r.critical_errors, {{"dura_by_burr", 0},
                            {"sagittal_sinus", 0},
                            {"brainstem", 0},
                            {"eloquent_zone", 0},
                            {"wrong_side", 0},
                            {"dry_catheter", 0}});
  return r;
}

inline const char* const perfect_marks =
    R"({"take": {"tool": "marker"}},
       {"trace": {"from": {"at": "bregma", "right_mm": 20}, "to": {"at": "bregma", "right_mm": -20}}},
       {"trace": {"from": {"at": "nasion"}, "to": {"at": "nasion", "along_mm": 110}}},
       {"trace": {"from": {"at": "nasion", "along_mm": 110}, "to": {"at": "nasion", "along_mm": 110, "right_mm": 27.5}}},
       "erase", "incise")";
inline const char* const perfect_hole =
    R"({"take": {"tool": "burr"}}, {"drill": {"past_mm": 3, "hole_diameter_mm": 12, "feed_force_n": 1.5}})";

}  // namespace lesson_cases
