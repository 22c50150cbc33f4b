// SPDX-License-Identifier: GPL-3.0-or-later
// Fronts of measured points, the rules that choose from them, and their file.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "base/write_file.h"
#include "config/config.h"
#include "config/trade_front.h"
#include "config/yaml_document.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

config::TradePoint point(const std::string& name, double seconds, double rms_mm, std::int64_t triangles) {
  config::TradePoint p;
  p.name = name;
  p.settings = {"*.decimate.max_deviation_mm=" + name};
  p.seconds = seconds;
  p.deviation_rms_mm = rms_mm;
  p.deviation_p99_mm = 2.5 * rms_mm;
  p.deviation_max_mm = 4 * rms_mm;
  p.triangles_count = triangles;
  p.bytes = 18 * triangles;
  return p;
}

// Errors fall steeply down to "knee" and hardly after it; "bad" is beaten, "none" was refused.
std::vector<config::TradePoint> points() {
  std::vector<config::TradePoint> all = {point("fine", 80, 0.04, 400000), point("fast", 5, 2, 5000),
                                         point("knee", 12, 0.06, 90000),  point("bad", 30, 0.5, 200000),
                                         point("mid", 8, 0.6, 30000),     point("none", 0, 0, 0)};
  all.back().refused = "brain.brain: finds nothing";
  return all;
}

std::vector<std::string> names(const std::vector<config::TradePoint>& all, const std::vector<std::size_t>& which) {
  std::vector<std::string> out;
  for (const std::size_t i : which) out.push_back(all[i].name);
  return out;
}

TEST(TradeFront, HoldsWhatNoOtherBeatsInBoth) {
  const auto all = points();
  EXPECT_EQ(names(all, config::pareto_front(all, config::TradeCost::seconds, config::TradeError::rms)),
            (std::vector<std::string>{"fast", "mid", "knee", "fine"}));
  EXPECT_EQ(config::pareto_front({}, config::TradeCost::bytes, config::TradeError::max), std::vector<std::size_t>{});
  // Of equal ones the first alone.
  const std::vector<config::TradePoint> twins = {point("a", 1, 1, 10), point("b", 1, 1, 10)};
  EXPECT_EQ(names(twins, config::pareto_front(twins, config::TradeCost::triangles, config::TradeError::p99)),
            std::vector<std::string>{"a"});
}

TEST(TradeChoice, AccuracyTakesTheFastestThatKeepsIt) {
  config::TradeRule rule;
  rule.max_deviation_mm = 0.3;
  const config::TradeChoice c = config::choose(points(), rule);
  EXPECT_EQ(c.point.name, "knee");
  EXPECT_NE(c.why.find("the fastest of 2 of 6 points that keep max_deviation_mm 0.3"), std::string::npos) << c.why;
}

// Other voxels are fast and look accurate on the head that was measured; on the next they are not.
TEST(TradeChoice, AccuracyIsNeverPromisedOfOtherVoxels) {
  std::vector<config::TradePoint> all = points();
  all.push_back(point("voxels", 6, 0.05, 80000));
  all.back().settings.insert(all.back().settings.begin(), "resample.spacing_mm=[1, 1, 1]");
  config::TradeRule rule;
  rule.max_deviation_mm = 0.3;
  EXPECT_EQ(config::choose(all, rule).point.name, "knee");
  config::TradeRule budget;
  budget.seconds = 10;
  EXPECT_EQ(config::choose(all, budget).point.name, "voxels");
}

TEST(TradeChoice, ABudgetTakesTheMostAccurateWithinIt) {
  config::TradeRule rule;
  rule.seconds = 10;
  EXPECT_EQ(config::choose(points(), rule).point.name, "mid");
  rule.seconds = 0;
  rule.triangles_count = 200000;
  EXPECT_EQ(config::choose(points(), rule).point.name, "knee");
  rule.seconds = 5;
  EXPECT_EQ(config::choose(points(), rule).point.name, "fast");
}

TEST(TradeChoice, WhatNobodyKeepsIsRefusedNamingTheNearest) {
  config::TradeRule rule;
  rule.rms_deviation_mm = 0.03;
  rule.seconds = 60;
  try {
    config::choose(points(), rule);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    const std::string said = e.what();
    EXPECT_NE(said.find("the nearest is fine"), std::string::npos) << said;
    // The remedy, followed to the letter, finds that point.
    const std::string key = "`accuracy.rms_deviation_mm` to ";
    const auto at = said.find(key);
    ASSERT_NE(at, std::string::npos) << said;
    EXPECT_NE(said.find("`budget.seconds` to 80,"), std::string::npos) << said;
    rule.rms_deviation_mm = std::stod(said.substr(at + key.size()));
    rule.seconds = 80;
    EXPECT_EQ(config::choose(points(), rule).point.name, "fine");
  }
}

TEST(TradeChoice, ProfilesAreTheEndsAndTheKneeOfTheFront) {
  config::TradeRule rule;
  const auto chosen = [&](const char* profile) {
    rule.profile = profile;
    return config::choose(points(), rule).point.name;
  };
  EXPECT_EQ(chosen("draft"), "fast");
  EXPECT_EQ(chosen("standard"), "knee");
  EXPECT_EQ(chosen("fine"), "fine");
  EXPECT_THROW(chosen("best"), Error);
  rule.profile = "standard";
  // Of two there is no knee: accuracy.
  EXPECT_EQ(config::choose({point("slow", 30, 0.17, 4), point("quick", 27, 1.1, 4)}, rule).point.name, "slow");
  // Of one point all three are it.
  EXPECT_EQ(config::choose({point("only", 1, 0.1, 4)}, rule).point.name, "only");
}

TEST(TradeChoice, MoreTrianglesThanTheSceneSaysAreForThoseWhoAskForThem) {
  config::TradePoint more = point("more", 5, 0.01, 90);
  more.settings = {"scene.triangles_ratio=2"};
  config::TradePoint fewer = point("fewer", 0.5, 0.9, 1);
  fewer.settings = {"scene.triangles_ratio=0.5"};
  std::vector<config::TradePoint> all = points();
  all.insert(all.end(), {more, fewer});
  const auto chosen = [&](const config::TradeRule& rule) { return config::choose(all, rule).point.name; };
  config::TradeRule profile;
  profile.profile = "draft";
  EXPECT_EQ(chosen(profile), "fewer");
  profile.profile = "standard";
  EXPECT_EQ(chosen(profile), "knee");
  profile.profile = "fine";
  EXPECT_EQ(chosen(profile), "more");
  config::TradeRule accuracy;
  accuracy.rms_deviation_mm = 0.011;
  EXPECT_THROW(chosen(accuracy), Error);
  accuracy.triangles_count = 100;
  EXPECT_EQ(chosen(accuracy), "more");
}

TEST(TradeFront, OfSeveralHeadsIsWhatHoldsForAll) {
  config::TradePoint a = point("a", 10, 0.1, 40), b = point("b", 20, 0.05, 50), only = point("only", 1, 0.3, 5);
  a.settings = {"x=1"}, b.settings = {"x=2"}, only.settings = {"x=3"};
  config::TradePoint other_a = a, other_b = b;
  other_a.seconds = 4, other_a.deviation_rms_mm = 0.2, other_a.triangles_count = 60;
  other_b.refused = "brain.brain: nothing";
  const auto all = config::points_of_all({{a, b, only}, {other_b, other_a}});
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].name, "a");
  EXPECT_EQ(all[0].seconds, 10);
  EXPECT_EQ(all[0].deviation_rms_mm, 0.2);
  EXPECT_EQ(all[0].triangles_count, 60);
  EXPECT_EQ(all[1].refused, "brain.brain: nothing");
  EXPECT_EQ(config::points_of_all({{a, b, only}}).size(), 3u);
  EXPECT_TRUE(config::points_of_all({{a}, {b}}).empty());
}

TEST(TradeFront, SecondsOfSeveralMachinesAreThoseOfTheFirst) {
  config::TradeFront first, second;
  first.points = second.points = {point("a", 10, 0.1, 40)};
  first.calibration_s = 0.02, second.calibration_s = 0.06;  // the second took three times as long for the same work
  auto sweeps = config::on_one_machine({first, second});
  EXPECT_EQ(sweeps[0][0].seconds, 10);
  EXPECT_NEAR(sweeps[1][0].seconds, 10 / 3.0, 1e-12);
  second.calibration_s = 0;  // measured by an older program
  EXPECT_EQ(config::on_one_machine({first, second})[1][0].seconds, 10);
}

TEST(TradeFile, TheShippedOnesBelongToTheShippedRecipes) {
  const std::filesystem::path configs = std::filesystem::path(TREPHINE_SOURCE_DIR) / "configs";
  int with_front = 0;
  for (const auto& entry : std::filesystem::directory_iterator(configs)) {
    if (entry.path().extension() != ".yaml") continue;
    const config::YamlNode tree = config::read_yaml(entry.path());
    if (!tree.find("trade") || !tree.find("pipeline")) continue;
    config::ConfigOverrides overrides;
    overrides.without_rule = true;
    const config::CaseConfig read = config::read_case_config(entry.path(), overrides);
    EXPECT_TRUE(read.trade.stale.empty()) << entry.path() << ": " << read.trade.stale[0];
    ++with_front;
  }
  EXPECT_GE(with_front, 1);
}

TEST(TradeFile, IsReadBackAndFaultsAreNamed) {
  const ScratchFolder folder;
  const auto file = folder.path() / "trade.json";
  const auto write = [&](const std::string& text) { write_file(file, text); };
  const std::string list = config::trade_points_json(points());
  write(R"({"format": "trephine.trade", "version": 1, "points": )" + list + "}");
  const auto read = config::read_trade_front(file).points;
  ASSERT_EQ(read.size(), 6u);
  EXPECT_EQ(config::trade_points_json(read), list);
  EXPECT_EQ(config::read_trade_front(file).calibration_s, 0);
  write(R"({"format": "trephine.trade", "version": 1, "calibration_s": 0.025, "points": )" + list + "}");
  EXPECT_EQ(config::read_trade_front(file).calibration_s, 0.025);
  const auto field_of = [&](const std::string& text) {
    write(text);
    try {
      config::read_trade_front(file);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      return e.field();
    }
    return std::string("read");
  };
  EXPECT_EQ(field_of(R"({"format": "trephine.trade", "version": 1, "recipe_sha256": 3, "points": )" + list + "}"),
            "recipe_sha256");
  EXPECT_EQ(field_of(R"({"format": "trephine.trade", "version": 1, "calibration_s": 0, "points": )" + list + "}"),
            "calibration_s");
  EXPECT_EQ(field_of("{"), "format");
  EXPECT_EQ(field_of("[]"), "format");
  EXPECT_EQ(field_of(R"({"format": 3})"), "format");
  EXPECT_EQ(field_of(R"({"format": "trephine.trade", "version": 2, "points": []})"), "version");
  EXPECT_EQ(field_of(R"({"format": "trephine.trade", "version": 1, "points": []})"), "points");
  EXPECT_EQ(field_of(R"({"format": "trephine.trade", "version": 1, "points": [{"name": 3}]})"), "points[0]");
}

}  // namespace
}  // namespace trephine
