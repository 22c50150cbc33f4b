// SPDX-License-Identifier: GPL-3.0-or-later
// Needles in pedicles of known axes: perfect, wrong and hostile ones, through the servo.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "base/error.h"
#include "lessons_spine.h"
#include "modules/lesson_run.h"
#include "scoring/attempts.h"
#include "scoring/report_page.h"
#include "scoring/score_spine_needle.h"
#include "scratch_folder.h"

using namespace lessons;

namespace {

SpineNeedleRubric shipped() {  // the test's own reading of configs/rubrics/spine_needle.yaml
  SpineNeedleRubric r;
  r.module = "spine_needle";
  const auto are = [](FourLimits& l, double five, double four, double three, double two) {
    const auto is = [](RubricLimit& m, double limit) { m = {limit, RubricLimit::From::ours, "test"}; };
    is(l.five, five), is(l.four, four), is(l.three, three), is(l.two, two);
  };
  are(r.entry_mm, 2, 4, 6, 10), are(r.target_mm, 3, 6, 9, 14), are(r.breach_mm, 0, 2, 4, 6);
  are(r.depth_mm, 5, 8, 12, 20), are(r.exposure_s, 5, 10, 20, 40), are(r.passes_count, 1, 2, 3, 5);
  are(r.procedure_s, 180, 300, 480, 720);
  r.least_confidence_ratio = {0.5, RubricLimit::From::ours, "test"};
  r.farthest_mm = {25, RubricLimit::From::ours, "test"};
  return r;
}

class SpineCase {
 public:
  explicit SpineCase(double confidence = 1) {
    spine_case(confidence).write(folder_.path());
    felt_ = std::make_unique<FeltCase>(folder_.path(), "");
    whole_ = felt_->loaded.haptic;
  }
  struct Done {
    Recording recording;
    SpineNeedleFacts facts;
    LessonScore score;
    const ScoreRow& row(const std::string& name) const {
      for (const ScoreRow& r : score.rows)
        if (r.name == name) return r;
      throw std::runtime_error(name);
    }
    int points(const std::string& name) const { return row(name).score.value_or(0); }
    double measured(const std::string& name) const {
      for (const ScoreRow& r : score.rows)
        for (const auto& [figure, value] : r.measured)
          if (figure == name) return value;
      return std::nan("");
    }
  };
  Done run(const std::string& steps, double noise_mm = 0) {
    felt_->loaded.haptic = whole_;
    LessonOptions o;
    o.script = parse_lesson_script(R"({"module": "spine_needle", "steps": [)" + steps + "]}");
    o.servo.rate_hz = 500;
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
    d.facts = dynamic_cast<const SpineNeedleFacts&>(*facts_of_recording(*felt_, "test", d.recording));
    d.score = score_spine_needle(d.facts, felt_->loaded.manifest, whole_, shipped());
  }
  FeltCase& felt() { return *felt_; }

 private:
  ScratchFolder folder_;
  std::unique_ptr<FeltCase> felt_;
  HapticVolume whole_;
};

SpineCase& spine() {
  static SpineCase one;
  return one;
}

std::string needle(const std::string& more = "", const std::string& pedicle = "pedicle_2_left") {
  return R"({"needle": {"pedicle": ")" + pedicle + "\"" + (more.empty() ? "" : ", " + more) + "}}";
}

}  // namespace

TEST(SpineNeedle, APerfectOneScoresFiveInAllRows) {
  const auto d = spine().run(R"({"shoot": {}}, "view_lateral", {"shoot": {}}, )" + needle() +
                             R"(, {"shoot": {}}, "view_ap", {"shoot": {"seconds": 1}}, "finish")");
  for (const ScoreRow& row : d.score.rows) {
    std::string measured;
    for (const auto& [name, value] : row.measured) measured += " " + name + " " + std::to_string(value);
    EXPECT_EQ(row.score, 5) << row.name << ": " << row.why << measured;
  }
  EXPECT_EQ(d.facts.end, LessonEnd::finished);
  ASSERT_EQ(d.facts.shots.size(), 4u);
  EXPECT_EQ(d.facts.shots[0].arm.view(), std::string("ap"));
  EXPECT_EQ(d.facts.shots[1].arm.view(), std::string("lateral"));
  EXPECT_NEAR(d.facts.exposure_s(), 3 * 0.4 + 1, 0.2);
  // The needle is in the picture at once, where it is.
  const NeedlePoint& end = d.facts.passes.back().path.back();
  EXPECT_LT(norm(d.facts.shots[3].tip_mm - end.tip_mm), 1);
  // Scored again it is the same.
  auto again = d;
  spine().score(again);
  const ReportHead head{"spine", "spine_needle", "p1", "a", "b", "c"};
  EXPECT_EQ(score_json(head, again.facts, again.score), score_json(head, d.facts, d.score));
  const std::string line = attempt_line(head, d.facts, d.score, 1);
  EXPECT_EQ(std::count(line.begin(), line.end(), ',') + 1,
            std::ptrdiff_t(attempt_columns(lesson_module("spine_needle")).size()));
  EXPECT_NE(report_page(head, d.facts, d.score, d.recording, spine().felt().loaded).find("pedicle_2_left"),
            std::string::npos);
}

TEST(SpineNeedle, ErrorsAreMeasuredAndScoredOnBothSidesOfTheirLimits) {
  for (const double aside : {1.2, 3.2, 5.2, 8.0}) {
    const auto d = spine().run(needle(fmt::format("\"entry_aside_mm\": {}, \"target_aside_mm\": {}", aside, aside)) +
                               R"(, {"shoot": {}}, "finish")");
    EXPECT_NEAR(d.measured("entry_off_mm"), aside, 0.7);
    EXPECT_NEAR(d.measured("target_off_mm"), aside, 0.7);
    EXPECT_EQ(d.points("entry"), shipped().entry_mm.score(d.measured("entry_off_mm")));
    EXPECT_EQ(d.points("entry"), aside < 2 ? 5 : aside < 4 ? 4 : aside < 6 ? 3 : 2);
  }
  const auto shallow = spine().run(needle("\"short_of_mm\": 15") + R"(, {"shoot": {}}, "finish")");
  EXPECT_NEAR(shallow.measured("depth_beyond_target_mm"), -15, 1.5);
  EXPECT_EQ(shallow.points("depth"), 2);
  EXPECT_EQ(shallow.points("target"), 5);
}

TEST(SpineNeedle, ABreachIsMeasuredWithItsSide) {
  // The half-width is 4.5 mm, the needle's 1.5: what is moved by d comes d - 3 through the wall.
  const auto at = [](double aside, double up) {
    return spine().run(
        needle(fmt::format(
            "\"entry_aside_mm\": {0}, \"target_aside_mm\": {0}, \"entry_up_mm\": {1}, \"target_up_mm\": {1}", aside,
            up)) +
        R"(, {"shoot": {}}, "finish")");
  };
  const auto within = at(-2, 0), medial = at(-5, 0), lateral = at(5, 0), lower = at(0, -8.5);
  EXPECT_EQ(within.points("breach"), 5) << within.row("breach").why;
  EXPECT_NEAR(medial.measured("breach_mm"), 2, 0.8);
  EXPECT_NE(medial.row("breach").why.find("medial"), std::string::npos) << medial.row("breach").why;
  EXPECT_TRUE(medial.score.flag("medial"));
  EXPECT_NEAR(lateral.measured("breach_mm"), 2, 0.8);
  EXPECT_NE(lateral.row("breach").why.find("lateral"), std::string::npos) << lateral.row("breach").why;
  EXPECT_NEAR(lower.measured("breach_mm"), 2.5, 1);
  EXPECT_NE(lower.row("breach").why.find("lower"), std::string::npos) << lower.row("breach").why;
}

TEST(SpineNeedle, EveryPassIsKeptAndTheWorstBreachCounts) {
  const auto d = spine().run(needle("\"entry_aside_mm\": -6, \"target_aside_mm\": -6") + ", " + needle() +
                             R"(, {"shoot": {}}, "finish")");
  ASSERT_EQ(d.facts.passes.size(), 2u);
  EXPECT_FALSE(d.facts.passes[0].in_place);
  EXPECT_TRUE(d.facts.passes[1].in_place);
  EXPECT_EQ(d.points("passes"), 4);
  EXPECT_EQ(d.points("entry"), 5);
  EXPECT_GT(d.measured("breach_mm"), 1);
  EXPECT_LT(d.points("breach"), 5);
}

TEST(SpineNeedleHostile, WithoutAnyPictureTheRowScoresOne) {
  const auto d = spine().run(needle() + R"(, "finish")");
  EXPECT_EQ(d.points("exposure"), 1);
  EXPECT_EQ(d.row("exposure").why, "no picture was taken");
  EXPECT_EQ(d.points("entry"), 5);
}

TEST(SpineNeedleHostile, ANeedleThatStaysOutsideScoresOneWhereItMatters) {
  for (const std::string& steps :
       {std::string(R"("finish")"), needle("\"short_of_mm\": 90") + R"(, "finish")",
        std::string(R"({"insert": {"from": {"at": "pedicle_2_left_entry", "offset_mm": [45, 0, 0]},
                                   "toward": {"at": "pedicle_2_left_target", "offset_mm": [45, 0, 0]}}}, "finish")")}) {
    const auto d = spine().run(steps);
    for (const char* row : {"entry", "target", "breach", "depth", "exposure", "passes"})
      EXPECT_EQ(d.points(row), 1) << row << " " << steps;
    EXPECT_FALSE(d.score.flag("at_pedicle"));
  }
}

TEST(SpineNeedleHostile, APauseCountsNothingAndTakesNoPicture) {
  const auto d = spine().run(R"("pause", {"wait": {"seconds": 3600}}, {"shoot": {"seconds": 5}}, "resume", )" +
                             needle() + R"(, {"shoot": {}}, "finish")");
  EXPECT_EQ(d.facts.pauses, 1);
  EXPECT_GT(d.facts.paused_s, 3600);
  EXPECT_LT(d.facts.procedure_s(), 60);
  EXPECT_EQ(d.facts.shots.size(), 1u);
  EXPECT_EQ(d.points("time"), 5);
}

TEST(SpineNeedleHostile, ALostDeviceEndsItAndKeepsWhatWasDone) {
  const auto d = spine().run(R"({"shoot": {}}, )" + needle() + R"(, "lose_device", "finish")");
  EXPECT_EQ(d.facts.end, LessonEnd::device_lost);
  EXPECT_EQ(d.points("time"), 1);
  EXPECT_EQ(d.facts.shots.size(), 1u);
  EXPECT_EQ(d.facts.passes.size(), 1u);
}

TEST(SpineNeedle, ADoubtfulPedicleIsNotJudged) {
  SpineCase doubtful(0.3);
  const auto d = doubtful.run(needle() + R"(, {"shoot": {}}, "finish")");
  for (const char* row : {"entry", "target", "breach", "depth"}) EXPECT_FALSE(d.row(row).score) << row;
  EXPECT_EQ(d.points("exposure"), 5);
}

TEST(SpineNeedle, ScriptsOfAnotherLessonAndPlacesThatAreNotThereAreRefused) {
  const auto refused = [](const std::string& steps, const std::string& field) {
    try {
      spine().run(steps);
      ADD_FAILURE() << steps;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      EXPECT_EQ(e.field(), field) << e.what();
    }
  };
  refused(R"("incise")", "steps[0]");
  refused(needle("", "pedicle_9_left"), "steps[0].needle: pedicle");
  refused(R"({"take": {"tool": "burr"}})", "steps[0].take: tool");
}
