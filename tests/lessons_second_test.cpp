// SPDX-License-Identifier: GPL-3.0-or-later
// The other hand in a lesson: what it holds, how it is judged, and what suction leaves of what bleeds.
#include <gtest/gtest.h>

#include "base/error.h"
#include "lessons/lesson_type.h"
#include "lessons/score.h"
#include "lessons/second_hand.h"

using namespace trephine;
using namespace trephine::lessons;

namespace {

constexpr Vec3 mouth{0, 0, 0}, source{0, 0, -10};

lesson::FourLimits limits(double five, double four, double three, double two) {
  const auto limit = [](double at) { return lesson::RubricLimit{at, lesson::RubricLimit::From::ours, "a test"}; };
  return {limit(five), limit(four), limit(three), limit(two)};
}

lesson::LessonRubric rubric() {
  lesson::LessonRubric r;
  r.second_hand = lesson::SecondHandRubric{limits(0.2, 0.5, 1, 2), limits(0.2, 0.5, 1, 3)};
  return r;
}

cases::CaseHaptic haptic() {
  cases::CaseHaptic h;
  for (const auto& [name, number] : {std::pair{"skull", 1}, {"brain", 2}}) {
    h.shapes.emplace_back();
    h.shapes.back().name = name;
    h.shapes.back().number = number;
  }
  return h;
}

// 1 ml/s since the tenth of twenty seconds.
LessonScore bleeding() {
  LessonScore score;
  CriticalError error;
  error.rule.error = "sagittal_sinus";
  error.rule.leads_to =
      lesson::Consequence{lesson::Fluid::venous_blood, {60, lesson::RubricLimit::From::ours, "a test"}};
  error.at_s = 10;
  error.seen.wound = Wound{source, mouth, 5};
  score.critical.push_back(error);
  return score;
}

LessonFacts facts_with(std::vector<SuctionSpell> spells) {
  LessonFacts f;
  f.end_s = 20;
  f.second.emplace();
  f.second->tool = "suction";
  f.second->suctions = std::move(spells);
  return f;
}

// Ticks in which the hand touches a shape with that force, or is in it.
SecondHandFacts watched(int touched, double force_n, int inside, bool paused = false, std::uint32_t faults = 0,
                        bool idle = false, std::uint32_t buttons = 1) {
  haptics::RecordedSecondHand held;
  held.tool.tool = held.tool.name = "suction";
  SecondHandWatch watch(held, spared_shapes({{}, {"brain"}}, haptic()));
  SecondHandFacts facts;
  for (int n = 0; n < 10; ++n) {
    haptics::ServoFrame f;
    f.time_s = 0.01 * (n + 1);
    f.dt_s = 0.01;
    f.touched = touched;
    f.inside = inside;
    f.force_n[2] = force_n;
    f.buttons = buttons;
    f.faults = faults;
    watch.look(f, paused, idle, facts);
  }
  return facts;
}

}  // namespace

TEST(SecondHand, LeavesTheBloodThatNobodyTookUp) {
  const LessonScore score = bleeding();
  const auto left = [&](std::vector<SuctionSpell> spells) { return blood_left(score, facts_with(std::move(spells))); };
  EXPECT_NEAR(left({}).left_ml, 10, 1e-9);
  EXPECT_TRUE(left({}).bled);
  EXPECT_NEAR(left({{15, 20, mouth}}).left_ml, 0, 1e-9);                    // 5 ml, which are gone after 2.5 s
  EXPECT_NEAR(left({{15, 16, mouth}}).left_ml, 7, 1e-9);                    // 3 of 6 ml, and 4 more well up
  EXPECT_NEAR(left({{15, 20, {0, 30, 0}}}).left_ml, 10, 1e-9);              // elsewhere
  EXPECT_NEAR(left({{5, 9, mouth}}).left_ml, 10, 1e-9);                     // before it bled
  EXPECT_NEAR(left({{15, 16, mouth}, {15, 16, source}}).left_ml, 7, 1e-9);  // two tubes take up what one does
  EXPECT_NEAR(left({{15, 16, mouth}}).suction_s, 1, 1e-9);
  EXPECT_FALSE(blood_left({}, facts_with({})).bled);
}

TEST(SecondHand, IsJudgedByItsForceOnWhatItMustSpare) {
  const auto points = [](const SecondHandFacts& second, LessonScore score = {}) {
    LessonFacts f;
    f.end_s = 20;
    f.second = second;
    judge_second_hand(score, f, rubric(), haptic());
    return score.row("second_hand") ? score.row("second_hand")->score.value_or(0) : -1;
  };
  EXPECT_EQ(points(watched(2, 0.1, 0)), 5);
  EXPECT_EQ(points(watched(2, 0.7, 0)), 3);
  EXPECT_EQ(points(watched(2, 3, 0)), 1);
  EXPECT_EQ(points(watched(1, 3, 0)), 5);         // the skull bears it
  EXPECT_EQ(points(watched(2, 0.1, 2)), 1);       // in the brain
  EXPECT_EQ(points(watched(2, 3, 2, true)), -1);  // nothing counts in a pause, not even that it held something
  EXPECT_EQ(points(watched(2, 3, 2, false, haptics::haptic_fault::gap)), 5);
  EXPECT_EQ(points(watched(2, 3, 2, false, haptics::haptic_fault::device_lost)), 0) << "not judged";
  SecondHandFacts weak = watched(2, 0.1, 0);
  weak.most_may_n = 0.15;
  EXPECT_EQ(points(weak), 0) << "not judged: its device could not press harder";
  weak.entered_s = 3, weak.entered = 2;
  EXPECT_EQ(points(weak), 1) << "what it did wrong counts";
  EXPECT_EQ(points(watched(2, 0.1, 0), bleeding()), 1);  // 10 ml are left
  LessonScore none;
  judge_second_hand(none, LessonFacts(), rubric(), haptic());
  EXPECT_TRUE(none.rows.empty());  // one hand
  EXPECT_NEAR(watched(0, 0, 0).switch_s, 0.1, 1e-9);
  EXPECT_TRUE(watched(0, 0, 0, false, 0, true).suctions.empty()) << "its belt waits";
  EXPECT_TRUE(watched(0, 0, 0, false, 0, false, 1 | haptics::haptic_button::lifted).suctions.empty());
  EXPECT_TRUE(watched(0, 0, 0, false, haptics::haptic_fault::gap).suctions.empty());
  ASSERT_EQ(watched(0, 0, 0).suctions.size(), 1u);
  EXPECT_NEAR(watched(0, 0, 0).suctions[0].end_s - watched(0, 0, 0).suctions[0].begin_s, 0.1, 1e-9);
}

TEST(SecondHand, HoldsWhatTheLessonHasForIt) {
  const auto held = [](const char* lesson, const std::string& asked) -> std::string {
    try {
      const auto tool = second_tool_of(lesson_type(lesson), asked);
      return tool ? tool->name : "a switch";
    } catch (const Error& e) {
      return e.field();
    }
  };
  EXPECT_EQ(held("ventriculostomy", ""), "suction");
  EXPECT_EQ(held("ventriculostomy", "irrigation"), "irrigation");
  EXPECT_EQ(held("ventriculostomy", "catheter"), "--second-tool");
  for (const char* lesson : {"spine_needle", "pedicle_finder", "pedicle_screw"}) {
    EXPECT_EQ(held(lesson, ""), "a switch") << lesson;
    EXPECT_EQ(held(lesson, "suction"), "--second-tool") << lesson;
  }
  EXPECT_EQ(held("subclavian", ""), "--second-device");
  for (const LessonType& type : lesson_types())  // what it may hold is among the lesson's own tools
    for (const std::string& kind : type.second.tools) EXPECT_TRUE(second_tool_of(type, kind)->blunt) << type.name;
}
