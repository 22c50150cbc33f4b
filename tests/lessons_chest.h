// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Lessons in the phantom of lessons_chest_phantom.h, done through the servo and scored.
#include <atomic>
#include <memory>
#include <stdexcept>

#include "lesson/subclavian_rubric.h"
#include "lessons_chest_phantom.h"
#include "modules/lesson_run.h"
#include "modules/subclavian.h"
#include "scoring/score_subclavian.h"
#include "scratch_folder.h"

namespace lessons_chest {

/// Lessons in that chest, done through the servo and scored. Each begins with the volume as it was.
class Chest {
 public:
  explicit Chest(bool artery) {
    chest_case(artery).write(folder_.path());
    felt_ = std::make_unique<FeltCase>(folder_.path(), "");
  }
  struct Done {
    Recording recording;
    SubclavianFacts facts;
    LessonScore score;
    const ScoreRow& row(const std::string& name) const {
      for (const ScoreRow& r : score.rows)
        if (r.name == name) return r;
      throw std::runtime_error(name);
    }
    int points(const std::string& name) const { return row(name).score.value_or(0); }  // 0: not judged
  };
  Done run(const std::string& steps, double rate_hz = 500, double noise_mm = 0) {
    LessonOptions o;
    o.script = parse_lesson_script("{\"module\": \"subclavian\", \"steps\": [" + steps + "]}");
    o.servo.rate_hz = rate_hz;
    o.aim.aim_noise_mm = noise_mm;
    o.most_s = 9000;
    const std::atomic<bool> stop{false};
    Done d;
    d.recording = run_lesson(*felt_, o, stop).recording;
    score(d);
    return d;
  }
  void score(Done& d) {
    d.facts = static_cast<const SubclavianFacts&>(*facts_of_recording(*felt_, "test", d.recording));
    d.score = score_subclavian(d.facts, felt_->loaded.manifest, felt_->loaded.haptic, rubric());
  }
  FeltCase& felt() { return *felt_; }

  /// Limits of the shipped rubric, as configs/rubrics/subclavian.yaml has them: the test's own reading of it.
  static SubclavianRubric rubric() {
    SubclavianRubric r;
    const auto is = [](RubricLimit& l, double limit) { l = {limit, RubricLimit::From::ours, "test"}; };
    r.module = "subclavian";
    is(r.puncture.ideal_mm, 20), is(r.puncture.far_mm, 40);
    is(r.direction.ideal_deg, 10), is(r.direction.good_deg, 15), is(r.direction.acceptable_deg, 25);
    is(r.passes.ideal_count, 1), is(r.passes.good_count, 2), is(r.passes.most_count, 3);
    is(r.time.ideal_s, 120), is(r.time.good_s, 240), is(r.time.acceptable_s, 360), is(r.time.allotted_s, 600);
    return r;
  }

 private:
  ScratchFolder folder_;
  std::unique_ptr<FeltCase> felt_;
};

}  // namespace lessons_chest
