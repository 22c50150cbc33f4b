// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Needles and screws in the spine of lessons_spine.h, done through the servo and scored.
#include "lessons/pedicle_finder/pedicle_finder_rubric.h"
#include "lessons/pedicle_screw/pedicle_screw_rubric.h"
#include "lessons/spine/five_errors_score.h"
#include "lessons/spine_needle/spine_needle_score.h"
#include "lessons_run.h"
#include "lessons_spine.h"

namespace lesson_cases {

inline lessons::SpineNeedleRubric shipped() {  // the test's own reading of configs/rubrics/spine_needle.yaml
  lessons::SpineNeedleRubric r;
  r.module = "spine_needle";
  are(r.entry_mm, 2, 4, 6, 10), are(r.target_mm, 3, 6, 9, 14), are(r.breach_mm, 0, 2, 4, 6);
  are(r.depth_mm, 5, 8, 12, 20), are(r.exposure_s, 5, 10, 20, 40), are(r.passes_count, 1, 2, 3, 5);
  are(r.procedure_s, 180, 300, 480, 720), are(r.insertion_mm_per_s.emplace(), 100, 150, 250, 350);
  is(r.least_confidence_ratio, 0.5), is(r.farthest_mm, 25);
  lists(r.critical_errors, {{"anterior_cortex_mm", 1},
                            {"canal", 0},
                            {"medial_breach_mm", 4},
                            {"other_breach_mm", 6},
                            {"beside_spine_mm", 10},
                            {"great_vessel", 0},
                            {"wrong_side", 0},
                            {"wrong_level", 0}});
  return r;
}

inline lessons::PedicleScrewRubric shipped_screw() {  // and of configs/rubrics/pedicle_screw.yaml
  lessons::PedicleScrewRubric r;
  r.module = "pedicle_screw";
  is(r.entry_mm, 4), is(r.axial_deg, 8), is(r.sagittal_deg, 8), is(r.length_mm, 6), is(r.breach_mm, 0);
  is(r.most_errors_count, 2), is(r.least_confidence_ratio, 0.5), is(r.farthest_mm, 25);
  is(r.head_mm.emplace(), 4), is(r.widest_ratio.emplace(), 0.8), is(r.narrowest_ratio.emplace(), 0.5);
  are(r.exposure_s.emplace(), 5, 10, 20, 40), are(r.passes_count.emplace(), 2, 3, 4, 6);
  are(r.procedure_s.emplace(), 300, 480, 720, 900), are(r.insertion_mm_per_s.emplace(), 100, 150, 250, 350);
  is(r.proud_mm.emplace(), 10), is(r.finder_ratio.emplace(), 0.5);
  lists(r.critical_errors, {{"anterior_cortex_mm", 1},
                            {"canal", 0},
                            {"medial_breach_mm", 4},
                            {"other_breach_mm", 6},
                            {"beside_spine_mm", 10},
                            {"great_vessel", 0},
                            {"wrong_side", 0},
                            {"wrong_level", 0}});
  return r;
}

inline lessons::PedicleFinderRubric shipped_finder() {  // and of configs/rubrics/pedicle_finder.yaml
  lessons::PedicleFinderRubric r;
  static_cast<lessons::FiveErrorsRubric&>(r) = shipped_screw();
  r.module = "pedicle_finder";
  for (auto* of_screws : {&r.head_mm, &r.widest_ratio, &r.narrowest_ratio, &r.proud_mm, &r.finder_ratio})
    of_screws->reset();
  are(r.passes_count.emplace(), 1, 2, 3, 5), are(r.procedure_s.emplace(), 180, 300, 480, 720);
  return r;
}

inline lessons::LessonScore score_screw(const lessons::SpineNeedleFacts& facts, const cases::CaseManifest& manifest,
                                        const voxel::HapticVolume& before,
                                        const lessons::PedicleScrewRubric& rubric = shipped_screw()) {
  return lessons::score_five_errors(facts, manifest, before, rubric, lessons::JudgedTool::screw);
}

class SpineCase : public LessonCase {
 public:
  explicit SpineCase(double confidence = 1) : LessonCase(spine_case(confidence)) {}
  struct Done : Scored<lessons::SpineNeedleFacts> {
    using Scored::measured;
    double measured(const std::string& name) const {  // of whatever row
      for (const lessons::ScoreRow& r : score.rows)
        for (const auto& [figure, value] : r.measured)
          if (figure == name) return value;
      return std::nan("");
    }
  };
  Done run(const std::string& steps, const std::string& module = "spine_needle", double noise_mm = 0,
           std::int64_t seed = 1, const std::string& task = "pedicle_2_left") {
    Done d;
    d.recording = record(module, steps, {500, noise_mm, seed, task});
    score(d);
    return d;
  }
  void score(Done& d) {
    d.facts = facts_of<lessons::SpineNeedleFacts>(d.recording);
    const cases::CaseManifest& manifest = felt().loaded.manifest;
    const std::string& lesson = d.recording.header.lesson;
    d.score = lesson == "spine_needle"     ? lessons::score_spine_needle(d.facts, manifest, whole(), shipped())
              : lesson == "pedicle_finder" ? lessons::score_five_errors(d.facts, manifest, whole(), shipped_finder(),
                                                                        lessons::JudgedTool::finder)
                                           : score_screw(d.facts, manifest, whole());
  }
};

}  // namespace lesson_cases
