// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Lessons in the phantom of lessons_chest_phantom.h, done through the servo and scored.
#include "lessons/subclavian/subclavian_rubric.h"
#include "lessons/subclavian/subclavian_score.h"
#include "lessons/subclavian/subclavian_watch.h"
#include "lessons_chest_phantom.h"
#include "lessons_run.h"

namespace lessons_chest {

class Chest : public ::lesson_cases::LessonCase {
 public:
  explicit Chest(bool artery) : LessonCase(chest_case(artery)) {}
  using Done = ::lesson_cases::Scored<lessons::SubclavianFacts>;
  Done run(const std::string& steps, double rate_hz = 500, double noise_mm = 0, const std::string& task = "") {
    Done d;
    d.recording = record("subclavian", steps, {rate_hz, noise_mm, 1, task});
    score(d);
    return d;
  }
  void score(Done& d) {
    d.facts = facts_of<lessons::SubclavianFacts>(d.recording);
    d.score = lessons::score_subclavian(d.facts, felt().loaded.manifest, whole(), rubric());
  }

  /// Limits of the shipped rubric, as configs/rubrics/subclavian.yaml has them: the test's own reading of it.
  static lessons::SubclavianRubric rubric() {
    lessons::SubclavianRubric r;
    using ::lesson_cases::is;
    r.module = "subclavian";
    is(r.puncture.ideal_mm, 20), is(r.puncture.far_mm, 40);
    is(r.direction.ideal_deg, 10), is(r.direction.good_deg, 15), is(r.direction.acceptable_deg, 25);
    is(r.passes.ideal_count, 1), is(r.passes.good_count, 2), is(r.passes.most_count, 3);
    is(r.time.ideal_s, 120), is(r.time.good_s, 240), is(r.time.acceptable_s, 360), is(r.time.allotted_s, 600);
    ::lesson_cases::are(r.insertion_mm_per_s.emplace(), 100, 150, 250, 350);
    ::lesson_cases::are(r.aspirations_count.emplace(), 4, 8, 12, 16);
    ::lesson_cases::are(r.beyond_vein_mm.emplace(), 3, 6, 10, 15);
    ::lesson_cases::lists(r.critical_errors, {{"artery", 0}, {"pleura_or_lung", 0}, {"wrong_side", 0}});
    return r;
  }
};

}  // namespace lessons_chest
