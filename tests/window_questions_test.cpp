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

std::vector<haptics::AskedQuestion> asked() {
  std::vector<haptics::AskedQuestion> all;
  for (const Question& q : rubric().questions) all.push_back({q.question, {"no", "yes"}});
  return all;
}

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
  questions.ask([] { return std::set<std::string>{"artery"}; });
  facts.end_s = 2.5;  // too soon to look again, but what was found is taken
  for (int n = 0; n < 60000 && questions.open(facts) < 0; ++n) {
    EXPECT_FALSE(questions.wants_errors(facts));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(questions.open(facts), 1);
  EXPECT_TRUE(questions.comes_before_end(facts));
  EXPECT_EQ(questions.open(facts), 1) << "what happened goes before the end";
  EXPECT_EQ(questions.answer(facts, "no"), haptics::belt_command::answer(1, 0));
  EXPECT_EQ(questions.open(facts), 3);
  EXPECT_FALSE(questions.comes_before_end(facts)) << "asked for a second time";
  facts.end = lessons::LessonEnd::finished;
  EXPECT_EQ(questions.open(facts), -1);
}

TEST(WindowQuestions, ATimeOutThatWasLeftOutIsNoLongerAsked) {
  const lesson::LessonRubric r = rubric();
  window::LessonQuestions questions(asked(), r);
  lessons::LessonFacts facts;
  facts.first_cut_s = 1;
  EXPECT_EQ(questions.open(facts), -1);
  EXPECT_FALSE(window::LessonQuestions({}, r).comes_before_end(facts)) << "nothing is asked";
}
