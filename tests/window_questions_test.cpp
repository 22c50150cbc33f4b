// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/lesson_questions.h"

#include <gtest/gtest.h>

#include <thread>

using namespace trephine;
using lesson::Question;

namespace {

// A time-out, what follows two critical errors, and the end.
lesson::LessonRubric rubric() {
  lesson::LessonRubric r;
  for (const auto& [name, when] : {std::pair<const char*, const char*>{"side", Question::before},
                                   {"blood", "artery"},
                                   {"air", "pleura_or_lung"},
                                   {"proof", Question::after}}) {
    Question q;
    q.question = name;
    q.when = when;
    q.choices = {{"yes", "Yes", "Ja", true}, {"no", "No", "", false}};
    r.questions.push_back(q);
  }
  return r;
}

std::vector<haptics::AskedQuestion> asked_of(const lesson::LessonRubric& r) {
  std::vector<haptics::AskedQuestion> all;
  for (const Question& q : r.questions) all.push_back({q.question, {"no", "yes"}});
  return all;
}
std::vector<haptics::AskedQuestion> asked() { return asked_of(rubric()); }

}  // namespace

TEST(WindowQuestions, EachHasItsTime) {
  const lesson::LessonRubric r = rubric();
  window::LessonQuestions questions(asked(), r);
  lessons::LessonFacts facts;
  EXPECT_EQ(questions.open(facts), 0) << "the time-out waits";
  EXPECT_EQ(questions.choices(facts), (std::vector<std::string>{"no", "yes"}));
  EXPECT_EQ(questions.text(0).choices[1].of(texts::Language::german), "Ja");
  EXPECT_EQ(questions.text(0).choices[0].of(texts::Language::german), "No") << "where there is no German";
  EXPECT_FALSE(questions.wants_errors(facts)) << "nothing was cut";
  EXPECT_EQ(questions.answer(facts, "perhaps"), haptics::belt_command::none);
  EXPECT_EQ(questions.answer(facts, "yes"), haptics::belt_command::answer(0, 1));
  EXPECT_EQ(questions.open(facts), -1) << "the rest has its time later";

  facts.first_cut_s = 1;
  facts.end_s = 2;
  ASSERT_TRUE(questions.wants_errors(facts));
  questions.ask([] {
    window::Happened happened{{"artery"}, {}, 0};
    happened.flows.emplace_back().fluid = lesson::Fluid::arterial_blood;
    return happened;
  });
  facts.end_s = 2.5;  // too soon to look again, but what was found is taken
  for (int n = 0; n < 60000 && questions.open(facts) < 0; ++n) {
    EXPECT_FALSE(questions.wants_errors(facts));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(questions.open(facts), 1);
  ASSERT_EQ(questions.flows().size(), 1u) << "it is seen";
  EXPECT_TRUE(questions.comes_before_end(facts));
  EXPECT_EQ(questions.open(facts), 1) << "what happened goes before the end";
  EXPECT_EQ(questions.answer(facts, "no"), haptics::belt_command::answer(1, 0));
  EXPECT_EQ(questions.open(facts), 3);
  EXPECT_FALSE(questions.comes_before_end(facts)) << "asked for a second time";
  facts.end = lessons::LessonEnd::finished;
  EXPECT_EQ(questions.open(facts), -1);
}

// What is seen of an error ends with the right answer, which scoring alone knows: it is asked again.
TEST(WindowQuestions, AnAnswerMayEndWhatIsSeen) {
  lesson::LessonRubric r = rubric();
  r.questions = {r.questions[1]};
  r.critical_errors.emplace_back().error = "artery";
  window::LessonQuestions nothing_seen(asked_of(r), r);
  nothing_seen.found({{"artery"}, {}, 0});
  r.critical_errors[0].leads_to.emplace().fluid = lesson::Fluid::arterial_blood;
  window::LessonQuestions questions(asked_of(r), r);
  EXPECT_TRUE(questions.waits_for_errors());
  questions.found({{"artery"}, std::vector<lessons::Flow>(1), 0});
  EXPECT_FALSE(questions.waits_for_errors());
  EXPECT_NE(questions.answer({}, "yes"), haptics::belt_command::none);
  EXPECT_TRUE(questions.waits_for_errors());
  questions.found({{"artery"}, std::vector<lessons::Flow>(1), 0});  // of somebody who looked before the answer
  EXPECT_TRUE(questions.waits_for_errors());
  questions.found({{}, {}, 1});
  EXPECT_FALSE(questions.waits_for_errors());
  EXPECT_TRUE(questions.flows().empty());
  EXPECT_NE(nothing_seen.answer({}, "yes"), haptics::belt_command::none);
  EXPECT_FALSE(nothing_seen.waits_for_errors()) << "nothing could end";
  // Unasked, it is looked for all the same.
  EXPECT_TRUE(window::LessonQuestions({}, r).waits_for_errors());
}

TEST(WindowQuestions, ATimeOutThatWasLeftOutIsNoLongerAsked) {
  const lesson::LessonRubric r = rubric();
  window::LessonQuestions questions(asked(), r);
  lessons::LessonFacts facts;
  facts.first_cut_s = 1;
  EXPECT_EQ(questions.open(facts), -1);
  EXPECT_FALSE(window::LessonQuestions({}, r).comes_before_end(facts)) << "nothing is asked";
}
