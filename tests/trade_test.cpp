// SPDX-License-Identifier: GPL-3.0-or-later
// A sweep of the sample's skin on coarse voxels: what is measured, that it goes on after a stop, and that a run gets
// what a rule chose.
#include "trade/trade.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/write_file.h"
#include "cases/case.h"
#include "publish/run_case.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;

const fs::path sample = fs::path(TREPHINE_SOURCE_DIR) / "sample_dicom";

class Trade : public testing::Test {
 protected:
  Trade() {
    write_file(at("recipe.yaml"), R"(trephine: 1
anatomies:
  skin:
    shows_face: false
    stages:
      - segment: {lower_hu: -475, components: largest, fill: cavities_and_cut}
      - contour
      - decimate
      - smooth
      - normals
)");
    write_file(at("scene.yaml"),
               "trephine: 1\nanatomies: {skin: {max_triangles: 2500, max_deviation_mm: 3}}\n"
               "face: {policy: keep, reason: synthetic}\n");
    write_file(at("case.yaml"), "trephine: 1\ncase: tiny\npipeline: recipe.yaml\nscene: scene.yaml\n");
    write_file(at("plan.yaml"), R"(trephine: 1
finest: {"*.decimate.max_deviation_mm": 0, "*.decimate.target_triangles_count": 0, "*.smooth.iterations_count": 0}
sweeps:
  bound:
    set: {"*.decimate.target_triangles_count": 0}
    values: {"*.decimate.max_deviation_mm": [0.3, 1, 2]}
  voxel:
    values: {resample.spacing_mm: [[8, 8, 8], [11, 11, 11]], skin.decimate.max_deviation_mm: [1]}
)");
    request.config = at("case.yaml");
    request.plan = at("plan.yaml");
    request.out = at("trade");
    request.overrides.series = sample;
    request.overrides.set = {"resample.spacing_mm=[6, 6, 6]"};
    request.params.repeats_count = 1;
    request.params.sample_count = 5000;
    request.program_version = "test";
  }
  fs::path at(const std::string& name) const { return folder.path() / name; }

  ScratchFolder folder;
  trade::TradeRequest request;
};

const trade::PointTrade& named(const trade::TradeResult& r, const std::string& name) {
  for (const trade::PointTrade& p : r.points)
    if (p.total.name == name) return p;
  throw std::runtime_error("no point " + name);
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

using Nobody = pipeline::RunObserver;

TEST_F(Trade, MeasuresEveryPointOnceAndSharesWhatPointsShare) {
  request.params.repeats_count = 2;
  const trade::TradeResult r = trade::measure_trade(request);
  ASSERT_EQ(r.points.size(), 6u);
  // import; then on three voxel sizes resample, segment, contour; decimate, smooth, normals, measure and the files of
  // six points (finest, three bounds, two voxel sizes), five compared with the finest. The contours of bounds 1 and 2
  // have a share of the bound.
  EXPECT_EQ(r.measured_count, 1 + 3 * 3 + 2 + 6 * 5 + 5);
  const trade::PointTrade &finest = r.points[0], &tight = named(r, "bound/0.3"), &loose = named(r, "bound/2");
  EXPECT_EQ(finest.total.deviation_max_mm, 0);
  EXPECT_LE(tight.total.deviation_max_mm, 0.3 + 0.1 + 1e-6);  // decimation's bound, and smoothing's
  EXPECT_LT(tight.total.deviation_rms_mm, loose.total.deviation_rms_mm);
  EXPECT_GT(tight.total.triangles_count, loose.total.triangles_count);
  EXPECT_GT(tight.total.bytes, loose.total.bytes);
  EXPECT_GT(named(r, "voxel/[11, 11, 11]/1").total.deviation_rms_mm,
            named(r, "voxel/[8, 8, 8]/1").total.deviation_rms_mm);
  EXPECT_NEAR(loose.anatomies[0].volume_ml,
              finest.anatomies[0].volume_ml * (1 + loose.anatomies[0].volume_change_percent / 100), 1e-6);
  for (const trade::PointTrade& p : r.points) {
    EXPECT_EQ(p.total.refused, "");
    double sum = 0;
    for (const trade::StageTrade& s : p.stages) sum += s.median_s;
    EXPECT_DOUBLE_EQ(p.total.seconds, sum);
    EXPECT_EQ(p.stages.back().name, "publish");
    EXPECT_GT(p.total.peak_memory_mb, 0);
  }
  // The finest has more triangles than the scene allows: it is measured, and never chosen.
  EXPECT_NE(finest.beyond_scene.find("the scene allows 2500"), std::string::npos) << finest.beyond_scene;
  for (const config::TradePoint& p : r.choosable()) EXPECT_LE(p.triangles_count, 2500);

  const trade::TradeResult again = trade::measure_trade(request);
  EXPECT_EQ(again.measured_count, 0);
  EXPECT_EQ(trade::trade_json(again, "test"), trade::trade_json(r, "test"));
}

TEST_F(Trade, ASweepThatWasStoppedGoesOn) {
  struct Stop {};
  int works = 0;
  std::string last;
  const trade::TradeObserver stop = [&](std::size_t, std::size_t, const std::string& work, double) {
    if (work != last && ++works == 12) throw Stop{};
    last = work;
  };
  EXPECT_THROW(trade::measure_trade(request, stop), Stop);
  const trade::TradeResult rest = trade::measure_trade(request);
  EXPECT_LT(rest.measured_count, 45 - 5);
  EXPECT_GT(rest.measured_count, 0);
  EXPECT_EQ(trade::measure_trade(request).measured_count, 0);
  // A damaged record is one that was never there.
  const fs::path records = at("trade") / ".trade" / "measured";
  fs::directory_iterator one(records);
  if (one->path().stem() == "calibration") ++one;  // how fast the machine is: no work of the sweep
  write_file(one->path(), "{\"report\"");
  EXPECT_EQ(trade::measure_trade(request).measured_count, 1);
  // What no point asks for any more goes.
  request.plan = at("less.yaml");
  write_file(request.plan, R"(trephine: 1
sweeps: {bound: {values: {skin.decimate.max_deviation_mm: [1]}}}
)");
  trade::measure_trade(request);
  const auto count = std::distance(fs::directory_iterator(records), fs::directory_iterator());
  EXPECT_EQ(count, 1 + 3 + 1 + 2 * 5 + 1 + 1);  // the last is how fast the machine is
}

TEST_F(Trade, WhatAGateRefusesIsAPointWithAReason) {
  request.params.max_repeat_s = 0;  // once, then
  write_file(request.plan, R"(trephine: 1
sweeps: {nothing: {values: {skin.segment.lower_hu: [30000]}}}
)");
  const trade::TradeResult r = trade::measure_trade(request);
  EXPECT_NE(r.points[1].total.refused.find("skin.segment"), std::string::npos) << r.points[1].total.refused;
  EXPECT_NE(trade::trade_table(r).find("refused: skin.segment"), std::string::npos);
}

TEST_F(Trade, TheFilesSayTheSame) {
  const trade::TradeResult r = trade::measure_trade(request);
  trade::write_trade(r, request.out, "test");
  const auto csv = lines_of(trade::trade_csv(r));
  ASSERT_EQ(csv.size(), 1 + 2 * r.points.size());  // the case and its one anatomy
  const auto cells = [](const std::string& line) {
    std::size_t count = 1;
    bool quoted = false;
    for (const char c : line) {
      quoted ^= c == '"';
      count += c == ',' && !quoted;
    }
    return count;
  };
  for (const std::string& line : csv) EXPECT_EQ(cells(line), cells(csv[0])) << line;
  const auto points = config::read_trade_front(request.out / "trade.json").points;
  EXPECT_EQ(config::trade_points_json(points), config::trade_points_json(r.choosable()));
  if (std::system("command -v gnuplot > /dev/null") != 0) {
    ASSERT_EQ(std::getenv("TREPHINE_CHECK"), nullptr) << "gnuplot is not installed";
    GTEST_SKIP() << "gnuplot is not installed";
  }
  for (const char* axis : {"seconds", "triangles", "bytes"})
    for (const char* ending : {".png", ".svg"})
      EXPECT_GT(fs::file_size(request.out / (std::string("error_") + axis + ending)), 5000u) << axis << ending;
  // Unchanged data draw nothing anew.
  const auto before = fs::last_write_time(request.out / "error_seconds.png");
  trade::write_trade(r, request.out, "test");
  EXPECT_EQ(fs::last_write_time(request.out / "error_seconds.png"), before);
}

TEST_F(Trade, ARunGetsThePointThatItsRuleChooses) {
  trade::write_trade(trade::measure_trade(request), request.out, "test");
  publish::RunRequest run;
  run.config = at("asks.yaml");
  run.library = at("library");
  run.overrides.series = sample;
  run.overrides.set = {"resample.spacing_mm=[6, 6, 6]"};
  run.params.use_cache = run.params.pictures = false;
  run.program_version = "test";
  const auto made = [&](const std::string& rule) {
    write_file(run.config, "trephine: 1\ncase: tiny\npipeline: recipe.yaml\nscene: scene.yaml\n" + rule);
    Nobody nobody;
    return cases::read_case(publish::run_case(run, nobody).case_folder);
  };
  const auto bound = [](const cases::CaseManifest& m) {
    for (const auto& [name, value] : m.parameters)
      if (name == "skin.decimate.max_deviation_mm") return std::get<double>(value);
    return -1.0;
  };
  const cases::CaseManifest accurate = made("trade: trade/trade.json\naccuracy: {max_deviation_mm: 1.5}\n");
  EXPECT_EQ(bound(accurate), 1);
  EXPECT_LE(accurate.anatomies[0].deviation.max_mm, 1.5);
  const cases::CaseManifest small = made("trade: trade/trade.json\nbudget: {triangles: 2500}\n");
  EXPECT_LE(small.anatomies[0].triangles, 2500u);
  const auto code_of = [&](const std::string& rule) {
    try {
      made(rule);
    } catch (const Error& e) {
      return e.code();
    }
    return ExitCode::ok;
  };
  EXPECT_EQ(code_of("trade: trade/trade.json\naccuracy: {max_deviation_mm: 0.01}\n"), ExitCode::quality);
  EXPECT_EQ(code_of("accuracy: {max_deviation_mm: 1}\n"), ExitCode::bad_config);
  EXPECT_EQ(code_of("trade: trade/trade.json\nprofile: best\n"), ExitCode::bad_config);
  EXPECT_EQ(code_of("trade: trade/trade.json\nprofile: fine\nbudget: {seconds: 9}\n"), ExitCode::bad_config);
  EXPECT_EQ(code_of("trade: none.json\nprofile: fine\n"), ExitCode::no_input);
  EXPECT_EQ(code_of("trade: [trade/trade.json, none.json]\nprofile: fine\n"), ExitCode::no_input);
  EXPECT_EQ(code_of("trade: [trade/trade.json, trade/trade.json]\nprofile: fine\n"), ExitCode::ok);
  EXPECT_EQ(code_of("trade: []\nprofile: fine\n"), ExitCode::bad_config);
  EXPECT_EQ(code_of("trade: {}\nprofile: fine\n"), ExitCode::bad_config);
  EXPECT_EQ(code_of("trade: trade/trade.json\nprofile: fine\n"), ExitCode::ok);
}

TEST_F(Trade, AFrontOfAnotherRecipeIsToldAndNotUsed) {
  trade::write_trade(trade::measure_trade(request), request.out, "test");
  const fs::path asks = at("asks.yaml");
  const auto read = [&](const std::string& trade) {
    write_file(asks,
               "trephine: 1\ncase: tiny\npipeline: recipe.yaml\nscene: scene.yaml\nprofile: fine\ntrade: " + trade);
    return config::read_case_config(asks, {}).trade;
  };
  const auto fault_of = [&](const std::string& trade) -> std::string {
    try {
      read(trade);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_config);
      return e.what();
    }
    return "none";
  };
  const std::vector<char> bytes = read_file(at("recipe.yaml"), 1 << 20);
  const std::string recipe(bytes.begin(), bytes.end());
  EXPECT_TRUE(read("trade/trade.json").stale.empty());
  write_file(at("recipe.yaml"), "# What it is for.\n" + recipe);  // says the same
  EXPECT_TRUE(read("trade/trade.json").stale.empty());

  write_file(at("recipe.yaml"), std::string(recipe).replace(recipe.find("-475"), 4, "-470"));
  EXPECT_NE(fault_of("trade/trade.json").find("was measured with another recipe"), std::string::npos);
  // A sweep of the case says so too, and its result is used beside the old one, which is told of.
  write_file(at("case.yaml"),
             "trephine: 1\ncase: tiny\npipeline: recipe.yaml\nscene: scene.yaml\ntrade: trade/trade.json\n");
  request.out = at("anew");
  const trade::TradeResult anew = trade::measure_trade(request);
  ASSERT_EQ(anew.stale.size(), 1u);
  trade::write_trade(anew, request.out, "test");
  const config::CaseTrade both = read("[trade/trade.json, anew/trade.json]");
  ASSERT_EQ(both.stale.size(), 1u);
  EXPECT_EQ(both.stale[0].rfind("trade.json was measured with another recipe", 0), 0u) << both.stale[0];
  ASSERT_EQ(both.fronts.size(), 1u);
  EXPECT_EQ(both.fronts[0].parent_path().filename(), "anew");

  write_file(at("old.json"), R"({"format": "trephine.trade", "version": 1, "points": )" +
                                 config::trade_points_json(anew.choosable()) + "}");
  EXPECT_NE(fault_of("old.json").find("does not say of which recipe"), std::string::npos);
}

TEST(TradePlan, EveryCombinationOnceTheLastParameterFastest) {
  trade::TradePlan plan;
  plan.sweeps = {{"a", {"x=1"}, {{"p", {"1", "2"}}, {"q", {"u", "v"}}}}, {"b", {}, {{"p", {"7"}}}}};
  std::vector<std::string> names;
  for (const trade::PlannedPoint& p : trade::points_of(plan)) names.push_back(p.name);
  EXPECT_EQ(names, (std::vector<std::string>{"finest", "a/1/u", "a/1/v", "a/2/u", "a/2/v", "b/7"}));
  EXPECT_EQ(trade::points_of(plan)[3].settings, (std::vector<std::string>{"x=1", "p=2", "q=u"}));
}

TEST(TradePlan, FaultsAreNamedWithTheirPlace) {
  const ScratchFolder folder;
  const fs::path file = folder.path() / "plan.yaml";
  const auto fault = [&](const std::string& text) {
    write_file(file, text);
    try {
      trade::read_trade_plan(file);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_config);
      return e.line("trade");
    }
    return std::string("read");
  };
  EXPECT_NE(fault("trephine: 1\n").find("sweeps: is missing"), std::string::npos);
  EXPECT_NE(fault("trephine: 1\nsweeps: {a: {values: {p: {x: 3}}}}\n").find("sweeps.a.values.p: must be a list"),
            std::string::npos);
  EXPECT_NE(fault("trephine: 1\nsweeps: {a: {values: {p: []}}}\n").find("sweeps.a.values.p: must be a list of values"),
            std::string::npos);
  EXPECT_NE(fault("trephine: 1\nsweeps: {a: {value: {p: [3]}}}\n").find("value"), std::string::npos);
  EXPECT_NE(fault("trephine: 1\nsweeps: {Big: {values: {p: [3]}}}\n").find("sweeps.Big"), std::string::npos);
  EXPECT_EQ(fault("trephine: 1\nsweeps: {a: {values: {p: [3, [1, 2, 3]]}}}\n"), "read");
}

TEST(TradePlan, TheStandardOneIsOfPathsThatAnyHeadHas) {
  for (const bool haptic : {false, true})
    for (const trade::PlannedPoint& p : trade::points_of(trade::standard_plan(haptic))) {
      config::ConfigOverrides overrides;
      overrides.set = p.settings;
      EXPECT_NO_THROW(config::read_case_config(
          fs::path(TREPHINE_SOURCE_DIR) / "configs" / (haptic ? "ct_head.yaml" : "ct_skull.yaml"), overrides))
          << p.name;
    }
}

}  // namespace
}  // namespace trephine
