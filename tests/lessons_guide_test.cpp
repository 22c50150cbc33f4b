// SPDX-License-Identifier: GPL-3.0-or-later
// What a participant reads before and during a lesson: each step has its reason and its sign, in every language.
#include "lessons/lesson_guide.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "lessons_chest.h"
#include "lessons_head.h"
#include "lessons_spine_run.h"

using namespace lesson_cases;
using texts::Language;

namespace {

// The lessons, each in a case that holds it.
void each_briefing(const std::function<void(const lessons::LessonType&, const lessons::LessonBriefing&)>& look) {
  Head head(Kind::whole);
  SpineCase spine;
  lessons_chest::Chest chest(false);
  for (const lessons::LessonType& type : lessons::lesson_types()) {
    SCOPED_TRACE(type.name);
    LessonCase& own = type.name == "ventriculostomy" ? static_cast<LessonCase&>(head)
                      : type.name == "subclavian"    ? static_cast<LessonCase&>(chest)
                                                     : spine;
    const std::vector<lessons::LessonTask> tasks = type.tasks(own.felt().loaded.manifest);
    ASSERT_FALSE(tasks.empty());
    for (const lessons::LessonTask& task : tasks) look(type, lessons::briefing_of(type, own.felt().loaded, task.name));
  }
}

bool translated(const std::string& english) { return lessons::lesson_words(Language::german, english) != english; }

TEST(LessonsGuide, ToolsAreNamedForAReader) {
  const auto german = [](const char* name) { return lessons::tool_title(Language::german, name); };
  EXPECT_EQ(german("burr_3"), "Bohrer 3 mm");
  EXPECT_EQ(german("burr_diamond_5"), "Diamantbohrer 5 mm");
  EXPECT_EQ(german("screw_5.5x40"), "Schraube 5.5 x 40 mm");
  EXPECT_EQ(german("catheter"), "Katheter");
  EXPECT_EQ(lessons::tool_title(Language::english, "burr_diamond_5"), "burr diamond 5 mm");
  for (const char* name : {"some_tool", "x", "a_", "_", "a_x", "tool_3x", ""})
    EXPECT_EQ(lessons::tool_title(Language::english, name), name);
}

}  // namespace

TEST(LessonsGuide, EveryLessonHasATitleInBothLanguages) {
  for (const lessons::LessonType& type : lessons::lesson_types()) {
    SCOPED_TRACE(type.name);
    const std::string english = lessons::lesson_title(type.name, Language::english);
    EXPECT_EQ(english.find('_'), std::string::npos) << english;
    const std::string german = lessons::lesson_title(type.name, Language::german);
    EXPECT_FALSE(german.empty());
    EXPECT_NE(german, english);
  }
}

// The first view of a lesson is from where its surgeon stands: on the side that is asked for.
TEST(LessonsGuide, TheSurgeonStandsOnTheSideThatIsAskedFor) {
  Head head(Kind::whole);
  const cases::LoadedCase& loaded = head.felt().loaded;
  const lessons::LessonType& type = lessons::lesson_type("ventriculostomy");
  EXPECT_TRUE(type.of_head);
  for (const std::string side : {"right", "left"}) {
    Head asked(Kind::whole);
    const Head::Done d = asked.run(R"({"take": {"tool": "marker"}})", 500, 1, 0, side);
    const Vec3 from = type.field(d.facts, loaded.manifest).from;
    EXPECT_NEAR(norm(from), 1, 1e-9);
    EXPECT_LT((side == "left" ? -1 : 1) * from.x, -0.3) << side;
    EXPECT_GT(from.z, 0.5) << "behind the head";
  }
}

TEST(LessonsGuide, EveryStepSaysWhyAndHowOneSeesThatItIsRight) {
  each_briefing([](const lessons::LessonType& type, const lessons::LessonBriefing& b) {
    EXPECT_NE(lessons::aim_of(b.task, Language::german), b.task.aim);
    EXPECT_NE(lessons::indication_of(b.task, Language::german), b.task.indication);
    EXPECT_FALSE(b.task.indication.empty());
    ASSERT_GE(b.steps.size(), 2u);
    EXPECT_EQ(b.steps.back().command, "finish");
    for (const lessons::LessonGuide& s : b.steps) {
      EXPECT_TRUE(translated(s.text)) << s.text;
      EXPECT_FALSE(s.why.empty()) << s.text;
      EXPECT_TRUE(translated(s.why)) << s.why;
      EXPECT_FALSE(s.sign.empty()) << s.text;
      EXPECT_TRUE(translated(s.sign)) << s.sign;
      bool any = s.tool.empty();
      for (const haptics::BeltToolParams& t : type.tools()) any = any || lessons::is_for_tool(s, t.name);
      EXPECT_TRUE(any) << s.text << " has the tool " << s.tool << ", which the lesson does not";
    }
  });
}

TEST(LessonsGuide, ACaseThatIsDrilledOnOneSideIsOfferedForThatSide) {
  Head head(Kind::whole);
  cases::CaseManifest manifest = head.felt().loaded.manifest;
  const lessons::LessonType& type = lessons::lesson_type("ventriculostomy");
  const auto sides = [&] {
    std::string all;
    for (const lessons::LessonTask& t : lessons::offered_tasks(type, manifest)) all += t.name + " ";
    return all;
  };
  manifest.burr_holes.clear();
  EXPECT_EQ(sides(), "right left ");
  cases::CaseBurrHole hole;
  hole.position_mm = {30, -40, 100};  // L
  manifest.burr_holes = {hole};
  EXPECT_EQ(sides(), "left ");
  EXPECT_EQ(lessons::use_of(type, manifest).tasks, std::vector<std::string>{"left"});
  EXPECT_EQ(lessons::task_of(type, manifest, "right").name, "right") << "what was recorded of it is judged";
  hole.position_mm.x = -30;
  manifest.burr_holes.push_back(hole);
  EXPECT_EQ(sides(), "right left ");
}

TEST(LessonsGuide, ACaseWithoutAForamenIsAnsweredWithWhatIsNeeded) {
  Head head(Kind::whole);
  cases::CaseManifest manifest = head.felt().loaded.manifest;
  const auto is_foramen = [](const auto& point) { return point.name.rfind("monro", 0) == 0; };
  auto& targets = manifest.targets;
  targets.erase(std::remove_if(targets.begin(), targets.end(), is_foramen), targets.end());
  auto& marks = manifest.landmarks;
  marks.erase(std::remove_if(marks.begin(), marks.end(), is_foramen), marks.end());
  const lessons::LessonUse use = lessons::use_of(lessons::lesson_type("ventriculostomy"), manifest);
  EXPECT_TRUE(use.tasks.empty());
  EXPECT_NE(use.why_not.find("needs a foramen of Monro as its target: monro_right or monro_left"), std::string::npos)
      << use.why_not;
}

TEST(LessonsGuide, TheTextHasAllOfItInEitherLanguage) {
  each_briefing([](const lessons::LessonType& type, const lessons::LessonBriefing& b) {
    for (const Language language : {Language::english, Language::german}) {
      const std::string text = lessons::briefing_text(type, b, language);
      const auto has = [&](const std::string& words) { return text.find(words) != std::string::npos; };
      EXPECT_TRUE(has(lessons::aim_of(b.task, language)) && has(lessons::indication_of(b.task, language))) << text;
      for (const lessons::LessonGuide& s : b.steps)
        for (const std::string& words : {s.text, s.why, s.sign})
          EXPECT_TRUE(has(lessons::lesson_words(language, words))) << words << "\n" << text;
    }
  });
}

// What stands in recordings and scripts as a name is a title for a reader.
TEST(LessonsGuide, EachToolHasATitleInEitherLanguage) {
  EXPECT_EQ(lessons::tool_title(Language::english, "screw_5.5x45"), "screw 5.5 x 45 mm");
  EXPECT_EQ(lessons::tool_title(Language::german, "screw_5.5x45"), "Schraube 5.5 x 45 mm");
  EXPECT_EQ(lessons::tool_title(Language::german, "needle"), "Nadel");
  for (const lessons::LessonType& type : lessons::lesson_types())
    for (const haptics::BeltToolParams& tool : type.tools()) {
      const std::string english = lessons::tool_title(Language::english, tool.name);
      EXPECT_EQ(english.find('_'), std::string::npos) << english;
      EXPECT_NE(lessons::tool_title(Language::german, tool.name), english);
    }
}

// How many steps of a guide are done, from the first on; none behind one that is not.
int done(const std::string& lesson, const lessons::LessonFacts& facts) {
  const std::vector<lessons::LessonGuide> steps = lessons::guide_of(lessons::lesson_type(lesson), facts);
  int count = 0;
  while (steps[std::size_t(count)].done) ++count;
  for (std::size_t n = std::size_t(count); n < steps.size(); ++n) EXPECT_FALSE(steps[n].done) << steps[n].text;
  return count;
}

TEST(LessonsGuide, AStepIsDoneWhenItIsSeenToBe) {
  lessons::VentriculostomyFacts head;
  EXPECT_EQ(done("ventriculostomy", head), 0);
  head.traces.resize(2);
  EXPECT_EQ(done("ventriculostomy", head), 0) << "the second is being drawn";
  head.end_s = 1;
  EXPECT_EQ(done("ventriculostomy", head), 1);
  head.traces[0].erased = true;
  EXPECT_EQ(done("ventriculostomy", head), 2);
  head.incisions.emplace_back();
  EXPECT_EQ(done("ventriculostomy", head), 3);
  head.hole.emplace();
  EXPECT_EQ(done("ventriculostomy", head), 3) << "not through";
  head.through_s = 20;
  EXPECT_EQ(done("ventriculostomy", head), 4);
  head.end_s = 30;
  lessons::CatheterPass& pass = head.passes.emplace_back();
  pass.end_s = 30;
  EXPECT_EQ(done("ventriculostomy", head), 4) << "no CSF";
  pass.csf_s = 29;
  EXPECT_EQ(done("ventriculostomy", head), 5);
  head.end_s = 31;
  EXPECT_EQ(done("ventriculostomy", head), 4) << "it was drawn out";

  lessons::SpineNeedleFacts spine;
  EXPECT_EQ(done("pedicle_screw", spine), 0);
  lessons::NeedlePass& finder = spine.passes.emplace_back();
  finder.tool = "finder";
  finder.end_s = spine.end_s = 10;
  EXPECT_EQ(done("pedicle_screw", spine), 0) << "it is in the bone";
  spine.end_s = 11;
  EXPECT_EQ(done("pedicle_screw", spine), 1);

  // Only what is drawn shows whether the needle is in the vein; what comes by itself does not end the step.
  lessons::SubclavianFacts chest;
  chest.vein_s = 5;
  EXPECT_EQ(done("subclavian", chest), 0);
  chest.passes.emplace_back().end_s = chest.end_s = 6;
  EXPECT_EQ(done("subclavian", chest), 1);
  chest.syringe = lesson::Fluid::air;
  EXPECT_EQ(done("subclavian", chest), 1);
  chest.blood_s = 6;
  EXPECT_EQ(done("subclavian", chest), 2);
  chest.end_s = 7;
  EXPECT_EQ(done("subclavian", chest), 0) << "it was drawn out";
}

TEST(LessonsGuide, AStepMayBeForAnyOfSeveralTools) {
  const lessons::LessonGuide screw{"", "screw_*", "", "", ""}, finder{"", "finder", "", "", ""}, none;
  EXPECT_TRUE(lessons::is_for_tool(screw, "screw_5.5x45") && lessons::is_for_tool(finder, "finder"));
  EXPECT_FALSE(lessons::is_for_tool(screw, "finder") || lessons::is_for_tool(finder, "finder_2") ||
               lessons::is_for_tool(none, ""));
}

// A syringe that drew nothing says so, as everything does that the panel lists, in the reader's language.
TEST(LessonsGuide, WhatASyringeHoldsIsReadInBothLanguages) {
  lessons_chest::Chest chest(false);
  const auto d = chest.run(R"("aspirate", "finish")");
  bool drew_nothing = false;
  for (const lessons::LessonStatus& s : lessons::lesson_type("subclavian").status(d.facts)) {
    if (s.name != "syringe") continue;
    drew_nothing = true;
    EXPECT_NE(lessons::lesson_words(Language::german, s.value), s.value);
  }
  EXPECT_TRUE(drew_nothing);
}
