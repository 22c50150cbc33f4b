// SPDX-License-Identifier: GPL-3.0-or-later
// Plans with tests, repeats and retention; results of a folder; what a teacher sees of a group.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "base/error.h"
#include "group/group_view.h"
#include "group/group_words.h"
#include "scratch_folder.h"

namespace {

using namespace trephine;
using namespace trephine::lessons;

std::vector<PlannedCase> cases(int count) {
  std::vector<PlannedCase> all;
  for (int n = 0; n < count; ++n) all.push_back({"c" + std::to_string(n), "normal", "right", "", 3});
  return all;
}
std::string told(const std::vector<PlannedCase>& plan) {
  std::string out;
  for (const PlannedCase& c : plan)
    out += (out.empty() ? "" : " ") + c.token + (c.phase.empty() ? "" : ":" + c.phase.substr(0, 2));
  return out;
}

TEST(GroupPlan, WithheldCasesAreTestedAndNotPractised) {
  CurriculumParams p;
  EXPECT_EQ(told(phased(cases(3), p)), "c0 c1 c2");
  p.test_cases_count = 2;
  p.rounds_count = 2;
  EXPECT_EQ(told(phased(cases(5), p)), "c1:be c3:be c0:pr c2:pr c4:pr c0:pr c2:pr c4:pr c1:af c3:af");
  p.test_cases_count = 6;
  EXPECT_THROW(phased(cases(5), p), Error);
}

TEST(GroupPlan, ARoundGoesBeforeTestsThatAreToDo) {
  CurriculumParams p;
  p.test_cases_count = 1;
  ExercisePlan plan;
  plan.cases = phased(cases(3), p);
  EXPECT_EQ(told(plan.cases), "c1:be c0:pr c2:pr c1:af");
  add_round(plan, 3);
  EXPECT_EQ(told(plan.cases), "c1:be c0:pr c2:pr c0:pr c2:pr c1:af");
  add_round(plan, 6);
  EXPECT_EQ(told(plan.cases), "c1:be c0:pr c2:pr c0:pr c2:pr c1:af c0:pr c2:pr");
  add_retention(plan);
  EXPECT_EQ(told(plan.cases).substr(told(plan.cases).size() - 5), "c1:re");
  ExercisePlan without;
  without.cases = cases(2);
  EXPECT_THROW(add_retention(without), Error);
}

class Group {
 public:
  // Fewer than 10 points are a failed attempt, and so is the one of `failed`, whatever its points.
  void participant(const std::string& name, const std::string& level, const std::vector<int>& points,
                   std::size_t failed = 99) {
    ExercisePlan plan;
    plan.participant = name;
    plan.module = "ventriculostomy";
    plan.level = level;
    const char* phases[] = {"before", "practice", "after", "retention"};
    for (std::size_t n = 0; n < points.size(); ++n) plan.cases.push_back({"case", "normal", "right", phases[n % 4], 3});
    write_plan(plan_file(folder, name, plan.module), plan);
    for (std::size_t n = 0; n < points.size(); ++n) {
      const std::filesystem::path report = planned_file(folder, plan, n, ".json");
      const bool fails = points[n] < 10 || n == failed;
      std::ofstream(report) << R"({"trephine_score": 2, "module": "ventriculostomy", "case": "case", "participant": ")"
                            << name << R"(", "motion_sha256": ")" << name << n << R"(", "outcome": ")"
                            << (fails ? "failed" : "completed") << R"(", "critical": [)"
                            << (fails ? R"({"error": "wrong_side"})" : "") << R"(], "points": )" << points[n]
                            << R"(, "most_points": 30, "rows": [{"name": "depth", "title": "Depth", "score": )"
                            << 1 + points[n] / 8
                            << R"(, "measured": {"depth_mm": 55.5}}], "figures": {"in_ventricle": true},)"
                            << R"("motion": {"path_mm": )" << 3000 - 50 * points[n] << "}}\n";
      if (n != 1) std::ofstream(std::filesystem::path(report).replace_extension(".lesson")) << "x";
    }
  }
  ScratchFolder scratch;
  std::filesystem::path folder = scratch.path();
};

TEST(GroupView, AFolderOfResultsIsRead) {
  Group g;
  g.participant("p1", "student", {9, 15, 21, 18});
  g.participant("p2", "expert", {28, 29, 30});
  std::ofstream(g.folder / "damaged.json") << R"({"trephine_score": 2, "module": )";
  std::ofstream(g.folder / "other.json") << "{}";
  const Results r = read_results(g.folder);
  ASSERT_EQ(r.attempts.size(), 7u);
  EXPECT_EQ(r.attempts[2].phase, "after");
  EXPECT_EQ(r.attempts[2].attempt, 3);
  EXPECT_EQ(r.attempts[0].level, "student");
  EXPECT_EQ(r.attempts[0].figure("in_ventricle"), 1);
  EXPECT_EQ(r.attempts[0].figure("depth_mm"), 55.5);
  const auto says = [&](const std::string& what) {
    return std::any_of(r.notes.begin(), r.notes.end(),
                       [&](const texts::Phrase& n) { return n.english().find(what) != std::string::npos; });
  };
  EXPECT_TRUE(says("damaged.json: left out"));
  EXPECT_TRUE(says("p1-ventriculostomy-02-case: the recording is gone"));
  EXPECT_FALSE(says("other.json"));
  EXPECT_THROW(read_results(g.scratch.path() / "nowhere"), Error);
}

TEST(GroupView, PointsAloneDoNotPass) {
  Group g;
  g.participant("s1", "student", {9, 15, 21});
  g.participant("s2", "student", {12, 13, 17});
  g.participant("e1", "expert", {28, 29, 30});
  g.participant("e2", "expert", {26, 28, 28}, 2);  // 28 of 30 points, and the wrong side
  group::GroupParams params;
  params.less_level = "student";
  params.more_level = "expert";
  const group::GroupView view = group::view_of(read_results(g.folder), params);
  const group::PassMark& mark = *view.modules.at(0).pass_mark;
  ASSERT_TRUE(mark.why_not.empty()) << mark.why_not;
  EXPECT_LT(mark.mark_ratio, 28 / 30.0);
  for (const auto& [participant, pass] : mark.passed) EXPECT_EQ(pass, participant == "e1") << participant;
  EXPECT_EQ(mark.more_fail_ratio, 0.5);
}

TEST(GroupView, RetentionFailuresAndThePassMark) {
  Group g;
  g.participant("s1", "student", {9, 15, 21, 18});
  g.participant("s2", "student", {12, 13, 17, 17});
  g.participant("s3", "student", {8, 14, 19, 19});
  g.participant("e1", "expert", {28, 29, 30});
  g.participant("e2", "expert", {26, 28, 28});
  g.participant("e3", "expert", {27, 28, 27});
  group::GroupParams params;
  params.less_level = "student";
  params.more_level = "expert";
  const group::GroupView view = group::view_of(read_results(g.folder), params);
  ASSERT_EQ(view.modules.size(), 1u);
  const group::ModuleView& m = view.modules[0];
  EXPECT_EQ(m.phases, (std::vector<std::string>{"before", "practice", "after", "retention"}));
  EXPECT_EQ(m.failures.at("wrong_side").size(), 2u);
  const auto s1 =
      std::find_if(m.participants.begin(), m.participants.end(), [](const auto& p) { return p.participant == "s1"; });
  EXPECT_NEAR(*s1->retained_ratio, (18.0 - 9) / (21 - 9), 1e-12);
  ASSERT_TRUE(m.pass_mark && m.pass_mark->why_not.empty()) << m.pass_mark->why_not;
  EXPECT_EQ(m.pass_mark->of, "phase after");
  EXPECT_GT(m.pass_mark->mark_ratio, 21 / 30.0);
  EXPECT_LT(m.pass_mark->mark_ratio, 27 / 30.0);
  EXPECT_EQ(m.pass_mark->less_pass_ratio, 0);
  EXPECT_EQ(m.pass_mark->more_fail_ratio, 0);
  ASSERT_EQ(m.bands.size(), 1u);
  EXPECT_EQ(m.bands[0].count, 9u);
  EXPECT_EQ(m.bands[0].low, 1500);
  params.less_level = "expert";
  params.more_level = "student";
  EXPECT_NE(group::view_of(read_results(g.folder), params).modules[0].pass_mark->why_not.find("is no better than"),
            std::string::npos);
  const std::string page = group::group_page(view, {});
  EXPECT_NE(page.find("wrong side"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
  group::GroupView noted = view;
  noted.notes = {{"{}: the recording is gone; the report stands and cannot be judged again", {"s1-01"}}};
  const std::string german = group::group_page(noted, {}, texts::Language::german);
  EXPECT_NE(german.find("die Aufnahme fehlt; der Bericht bleibt"), std::string::npos);
  EXPECT_NE(german.find("s1-01: die Aufnahme fehlt"), std::string::npos);
  EXPECT_EQ(group::group_words(texts::Language::german,
                               {"{} by {}, {}", {"points", "level", texts::Phrase("phase {}", {"before"})}}),
            "Punkte nach Stufe, Phase vorher");
  EXPECT_NE(german.find("Weg der Hand, mm"), std::string::npos);
  for (const char* said : {"lang=\"de\"", "Eine Gruppe von 6 Teilnehmern, 21 Versuche", "falsche Seite", "nachher",
                           "Bestehensgrenze", "Nach der Phase nachher", "Weg der Hand", "Bestanden:"})
    EXPECT_NE(german.find(said), std::string::npos) << said;
  for (const char* english :
       {">participant", "Pass mark", "wrong side", "Critical", "Passed:", ">after", "of the points"})
    EXPECT_EQ(german.find(english), std::string::npos) << english;
}

}  // namespace
