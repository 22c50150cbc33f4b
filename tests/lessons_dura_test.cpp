// SPDX-License-Identifier: GPL-3.0-or-later
// A dura that is felt: a catheter pops through it, a burr presses on it.
#include <gtest/gtest.h>

#include "lessons_head.h"

using namespace lesson_cases;

namespace {

const lessons::LessonFigure& figure(const Head::Done& d, const char* name) { return d.score.figure(name); }

}  // namespace

TEST(LessonsDura, ACatheterPopsThroughAndABurrStaysOutside) {
  Head head(Kind::whole, 1, true);
  const Head::Done d =
      head.run(std::string(perfect_marks) +
               // Wide, for a ball leaves a bowl, and the catheter slides along the ventricle's wall before it pops in.
               R"(, {"take": {"tool": "burr"}}, {"drill": {"past_mm": 3, "hole_diameter_mm": 18, "feed_force_n": 1.5}},
         {"take": {"tool": "catheter"}}, {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}}, "finish")");
  ASSERT_TRUE(d.facts.dura.has_value());
  ASSERT_EQ(d.facts.dura->pops.size(), 1u);
  const lessons::DuraPop& pop = d.facts.dura->pops[0];
  EXPECT_NEAR(norm(pop.at_mm), inner_mm, 1) << "it was held at the dura's outer surface";
  EXPECT_GT(pop.force_n, 0.9);
  ASSERT_EQ(d.facts.passes.size(), 1u);
  EXPECT_LE(pop.time_s, d.facts.passes[0].begin_s);
  EXPECT_GT(d.facts.dura->burr_s, 0);
  EXPECT_GT(d.facts.dura->burr_n, 0);
  EXPECT_LT(d.facts.dura->burr_first_s, pop.time_s);
  EXPECT_TRUE(std::get<bool>(figure(d, "dura_passed").value));
  EXPECT_EQ(std::get<double>(figure(d, "burr_on_dura_n").value), d.facts.dura->burr_n);
  EXPECT_EQ(std::get<bool>(figure(d, "dura_breached").value), d.facts.dura->breach.has_value());
  for (const char* row : {"landmarks", "burr_hole", "trajectory", "depth", "tip", "time"})
    EXPECT_EQ(d.points(row), 5) << row << ": " << d.row(row).why;
}

TEST(LessonsDura, ACaseWithoutOneSaysNothingOfIt) {
  Head head(Kind::drilled);
  const Head::Done d = head.run(
      R"({"take": {"tool": "catheter"}}, {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 4}}, "finish")");
  EXPECT_FALSE(d.facts.dura.has_value());
  EXPECT_FALSE(d.score.known("dura_passed"));
  EXPECT_FALSE(d.score.known("burr_on_dura_n"));
}

// What the watch makes of single frames.
TEST(LessonsDura, ABreachIsMoreThanTheDuraBears) {
  const cases::CaseManifest m = head_case(Kind::drilled, 1, true).manifest;
  std::optional<lessons::DuraFacts> facts;
  lessons::DuraWatch watch(m, facts);
  ASSERT_TRUE(facts.has_value());
  haptics::ServoFrame f;
  f.dt_s = 0.5;
  f.touched = 5;
  f.force_n[2] = 0.9;
  watch.tick(f, true, facts);
  EXPECT_FALSE(facts->breach);
  f.force_n[2] = 1.1;
  watch.tick(f, false, facts);
  EXPECT_FALSE(facts->breach) << "the burr stood still";
  watch.tick(f, true, facts);
  EXPECT_TRUE(facts->breach);
  EXPECT_DOUBLE_EQ(facts->burr_s, 1);
  EXPECT_DOUBLE_EQ(facts->burr_n, 1.1);
  f.touched = 2;
  watch.tick(f, false, facts);
  f.events = haptics::haptic_event::popped;  // through the brain's surface
  watch.tick(f, false, facts);
  EXPECT_TRUE(facts->pops.empty());
}

// A burr hole ends at the dura: it is reached, and a moment's press as the inner table gives way is no breach.
TEST(LessonsDura, ReachingTheDuraIsNoErrorAndPressingOnIs) {
  const cases::CaseManifest m = head_case(Kind::drilled, 1, true).manifest;
  haptics::ServoFrame f;
  f.dt_s = 0.001;
  f.touched = 5;
  const auto breached = [&](const std::vector<double>& forces_n) {
    std::optional<lessons::DuraFacts> facts;
    lessons::DuraWatch watch(m, facts);
    for (const double force_n : forces_n) {
      f.force_n[2] = force_n;
      watch.tick(f, true, facts);
    }
    return facts->breach.has_value();
  };
  EXPECT_FALSE(breached(std::vector<double>(60000, 0.99)));
  std::vector<double> moment(9, 3.0);
  moment.push_back(0.9);
  moment.insert(moment.end(), 9, 3.0);
  EXPECT_FALSE(breached(moment)) << "twice 9 ms, and let go between";
  EXPECT_TRUE(breached(std::vector<double>(10, 1.1)));
}
