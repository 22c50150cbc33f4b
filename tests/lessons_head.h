// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Lessons in the phantom of lessons_phantom.h, done through the servo and scored.
#include <memory>
#include <stdexcept>

#include "lessons_phantom.h"
#include "modules/lesson_run.h"
#include "scoring/score_ventriculostomy.h"
#include "scratch_folder.h"

namespace lessons {

/// The case on disk, loaded once; each lesson begins with the volume as it was.
class Head {
 public:
  explicit Head(Kind kind, double suture_confidence = 1) {
    head_case(kind, suture_confidence).write(folder_.path());
    felt_ = std::make_unique<FeltCase>(folder_.path(), "");
    whole_ = felt_->loaded.haptic;
  }

  struct Done {
    Recording recording;
    VentriculostomyFacts facts;
    LessonScore score;
    const ScoreRow& row(const std::string& name) const {
      for (const ScoreRow& r : score.rows)
        if (r.name == name) return r;
      throw std::runtime_error(name);
    }
    int points(const std::string& name) const { return row(name).score.value_or(0); }  // 0: not judged
    double measured(const std::string& row_name, const std::string& figure) const {
      for (const auto& [name, value] : row(row_name).measured)
        if (name == figure) return value;
      return std::nan("");
    }
    Vec3 last_tip() const {
      const ServoFrame& f = recording.frames.back();
      return {f.proxy_mm[0], f.proxy_mm[1], f.proxy_mm[2]};
    }
  };

  /// Does the steps through the servo, and scores the recording.
  Done run(const std::string& steps, double rate_hz = 500, std::int64_t seed = 1, double noise_mm = 0) {
    felt_->loaded.haptic = whole_;
    LessonOptions o;
    o.script = parse_lesson_script("{\"module\": \"ventriculostomy\", \"steps\": [" + steps + "]}");
    o.servo.rate_hz = rate_hz;
    o.aim.seed = seed;
    o.aim.aim_noise_mm = noise_mm;
    o.most_s = 9000;
    const std::atomic<bool> stop{false};
    Done d;
    d.recording = run_lesson(*felt_, o, stop).recording;
    score(d);
    return d;
  }
  void score(Done& d) {
    felt_->loaded.haptic = whole_;
    d.facts = dynamic_cast<const VentriculostomyFacts&>(*facts_of_recording(*felt_, "test", d.recording));
    d.score = score_ventriculostomy(d.facts, felt_->loaded.manifest, whole_, rubric());
  }
  FeltCase& felt() { return *felt_; }
  const HapticVolume& whole() const { return whole_; }
  const std::filesystem::path& path() const { return folder_.path(); }

  /// Limits of the shipped rubric, as configs/rubrics/ventriculostomy.yaml has them: the test's own reading of it.
  static VentriculostomyRubric rubric();

 private:
  ScratchFolder folder_;
  std::unique_ptr<FeltCase> felt_;
  HapticVolume whole_;
};

inline VentriculostomyRubric Head::rubric() {
  VentriculostomyRubric r;
  const auto is = [](RubricLimit& l, double limit) { l = {limit, RubricLimit::From::ours, "test"}; };
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
  is(r.tip.foramen_mm, 5), is(r.tip.near_mm, 10), is(r.tip.missed_mm, 3);
  is(r.tip.least_confidence_ratio, 0.5);
  is(r.time.ideal_s, 300), is(r.time.good_s, 450), is(r.time.acceptable_s, 600), is(r.time.allotted_s, 900);
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

}  // namespace lessons
