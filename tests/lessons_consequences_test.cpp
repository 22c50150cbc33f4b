// SPDX-License-Identifier: GPL-3.0-or-later
// What is seen of a critical error, where, and how long; and which tool of a ventriculostomy goes into the brain.
#include <gtest/gtest.h>

#include "lessons/consequences.h"
#include "lessons_head.h"
#include "lessons_spine_run.h"

using namespace lesson_cases;

namespace {

constexpr const char* to_the_foramen =
    R"({"take": {"tool": "catheter"}}, {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}}, "finish")";

}  // namespace

TEST(LessonsConsequences, ABreachedDuraBleedsIntoTheHoleUntilThatIsAnswered) {
  Head head(Kind::drilled);
  lessons::VentriculostomyFacts facts = head.run(to_the_foramen).facts;
  EXPECT_EQ(facts.catheter_mm, 2.5) << "suction and saline are no catheters";
  facts.dura.emplace().breach = lessons::DuraPop{12.5, {1, 2, 3}, 1.4};
  lessons::VentriculostomyRubric rubric = Head::rubric();
  for (lesson::CriticalRule& rule : rubric.critical_errors)
    if (rule.error == "dura_by_burr") rule.leads_to = lesson::Consequence{lesson::Fluid::venous_blood, {}};
  lessons::LessonScore score = lessons::score_ventriculostomy(facts, head.felt().loaded.manifest, head.whole(), rubric);
  const auto bleeding = [&] {
    const std::vector<lessons::Flow> flows = lessons::flows_of(score);
    EXPECT_EQ(flows.size(), 1u);
    return flows.empty() ? lessons::Flow() : flows.front();
  };
  EXPECT_EQ(bleeding().fluid, lesson::Fluid::venous_blood);
  EXPECT_EQ(bleeding().seen.wound->source_mm.y, 2);
  EXPECT_EQ(norm(bleeding().seen.wound->mouth_mm - facts.hole->outer_mm), 0);
  EXPECT_FALSE(bleeding().runs(12.4));
  EXPECT_TRUE(bleeding().runs(1e6));
  lessons::Decision& answered = score.decisions.emplace_back();
  answered.when = "dura_by_burr";
  answered.at_s = 30;
  answered.state = lessons::AnswerState::wrong;
  EXPECT_TRUE(bleeding().runs(31));
  answered.state = lessons::AnswerState::right;
  EXPECT_TRUE(bleeding().runs(29));
  EXPECT_FALSE(bleeding().runs(31));
}

TEST(LessonsConsequences, OneToolAloneGoesIn) {
  int go_in = 0;
  for (const haptics::BeltToolParams& t : lessons::ventriculostomy_tools()) go_in += !t.blunt;
  EXPECT_EQ(go_in, 1);
}

// CSF drips from a needle as long as its tip is in the canal.
TEST(LessonsConsequences, ANeedleInTheCanalDripsThere) {
  SpineCase spine;
  const int canal = spine.felt().loaded.haptic.find_shape("canal")->number;
  auto d =
      spine.run(R"({"needle": {"pedicle": "pedicle_2_left", "entry_aside_mm": -2, "target_aside_mm": -22}}, "finish")");
  for (lessons::CriticalError& e : d.score.critical)
    if (e.rule.error == "canal") {
      EXPECT_EQ(e.seen.shape, canal);
      EXPECT_FALSE(e.seen.wound);
      e.rule.leads_to = lesson::Consequence{lesson::Fluid::csf, {}};
    }
  ASSERT_TRUE(failed_by(d.score, "canal")) << d.score.reason();
  ASSERT_EQ(lessons::flows_of(d.score).size(), 1u);
  EXPECT_EQ(lessons::flows_of(d.score)[0].seen.shape, canal);
}
