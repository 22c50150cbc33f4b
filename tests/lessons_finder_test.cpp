// SPDX-License-Identifier: GPL-3.0-or-later
// The pedicle finder alone: the five errors, and what it cost.
#include <gtest/gtest.h>

#include "lessons_spine_run.h"

using namespace lesson_cases;

namespace {

SpineCase& spine() {
  static SpineCase one;
  return one;
}

std::string needle(const std::string& more) {
  return R"({"needle": {"pedicle": "pedicle_2_left")" + (more.empty() ? "" : ", " + more) + "}}";
}

}  // namespace

// Group B of chapter 8.2.2 did the finder alone: the same errors as of the screw that would follow, and what it cost.
TEST(PedicleFinder, IsJudgedByTheFiveErrors) {
  const auto finder = [](const std::string& more) {
    return spine().run(R"({"shoot": {}}, )" + needle(more) + R"(, {"shoot": {}}, "finish")", "pedicle_finder");
  };
  const auto perfect = finder("");
  for (const lessons::ScoreRow& r : perfect.score.rows) EXPECT_EQ(r.score, 5) << r.name << ": " << r.why;
  EXPECT_EQ(perfect.score.row("size"), nullptr) << "it is no screw";
  EXPECT_EQ(lessons::sum_of(perfect.score).most, 45);
  EXPECT_TRUE(perfect.score.flag("finder_in_bone"));
  EXPECT_EQ(perfect.score.count("errors_count"), 0);
  EXPECT_EQ(perfect.score.count("gertzbein_grade"), 0);
  EXPECT_EQ(finder("\"short_of_mm\": 8").points("length"), 1);
  const auto tilted = finder("\"entry_up_mm\": 3, \"target_up_mm\": -5, \"short_of_mm\": 10");
  EXPECT_EQ(tilted.score.count("errors_count"), 2);
  EXPECT_EQ(tilted.points("acceptable"), 5) << "two are";
  const auto bad = finder("\"entry_up_mm\": 5.5, \"target_up_mm\": -7, \"short_of_mm\": 10");
  EXPECT_GE(bad.score.count("errors_count"), 3);
  EXPECT_EQ(bad.points("acceptable"), 1);
  bool told = false;
  for (const lessons::Advice& a : bad.score.advice)
    told = told || a.of(texts::Language::english).find("turn the finder") != std::string::npos;
  EXPECT_TRUE(told);
  // The same hand with a screw makes the same errors: the groups can be compared.
  const auto screw = spine().run(R"({"shoot": {}}, {"take": {"tool": "screw_5.5x45"}}, )" +
                                     needle("\"entry_up_mm\": 3, \"target_up_mm\": -5, \"short_of_mm\": 10") +
                                     R"(, {"shoot": {}}, "finish")",
                                 "pedicle_screw");
  EXPECT_EQ(screw.score.count("errors_count"), 2);
}

TEST(PedicleFinder, WhoPutsItNowhereEarnsNothing) {
  const auto d = spine().run(R"({"shoot": {}}, "finish")", "pedicle_finder");
  EXPECT_FALSE(d.score.flag("finder_in_bone"));
  EXPECT_EQ(d.score.reason(), "no finder lies in bone");
  for (const lessons::ScoreRow& r : d.score.rows) EXPECT_EQ(r.score, 1) << r.name;
  EXPECT_EQ(lessons::lesson_type("pedicle_finder").tools().size(), 1u);
  EXPECT_EQ(lessons::lesson_type("pedicle_finder").tools()[0].name, "finder");
}
