// SPDX-License-Identifier: GPL-3.0-or-later
#include "trade/plan.h"

#include <set>

#include "config/declared.h"
#include "config/said.h"

namespace trephine::trade {
namespace {

/// The declaration of a plan's file (configs/trade/*.yaml).
struct SweptValues {
  std::vector<config::SaidValue> values;
  template <class V>
  static void describe(V& v) {
    v.list(&SweptValues::values, "", "The values that the parameter takes, each as --set takes it.").is_required();
  }
};

struct SweepParams {
  Named<config::SaidValue> set;
  Named<SweptValues> values;
  template <class V>
  static void describe(V& v) {
    using P = SweepParams;
    v.map(&P::set, "set", "Parameters of every point of the sweep, by their paths.");
    v.map(&P::values, "values",
          "Parameters by their paths and the values that each takes; every combination is a point.")
        .is_required();
  }
};

struct TradeFileParams : config::VersionParams {
  Named<config::SaidValue> finest;
  Named<SweepParams> sweeps;
  template <class V>
  static void describe(V& v) {
    using P = TradeFileParams;
    v.template all_of<config::VersionParams>();
    v.map(&P::finest, "finest", "Parameters of the result that all others are measured against.");
    v.map(&P::sweeps, "sweeps", "The sweeps by name.").names("name").is_required();
  }
};

std::string voxels(double mm) {
  const std::string s = to_text(ParameterValue(mm));
  return "[" + s + ", " + s + ", " + s + "]";
}

}  // namespace

std::vector<PlannedPoint> points_of(const TradePlan& plan) {
  std::vector<PlannedPoint> points{{"finest", "finest", plan.finest}};
  std::set<std::string> known{"finest"};
  for (const TradeSweep& sweep : plan.sweeps) {
    std::size_t count = 1;
    for (const SweptParameter& p : sweep.values) count *= p.values.size();
    for (std::size_t i = 0; i < count; ++i) {
      PlannedPoint point{sweep.name, sweep.name, sweep.settings};
      std::size_t rest = i, below = count;
      for (const SweptParameter& p : sweep.values) {
        below /= p.values.size();
        const std::string& value = p.values[rest / below];
        rest %= below;
        point.name += "/" + value;
        point.settings.push_back(p.path + "=" + value);
      }
      if (known.insert(point.name).second) points.push_back(std::move(point));
    }
  }
  return points;
}

TradePlan standard_plan(bool haptic) {
  const std::string bound = "*.decimate.max_deviation_mm", count = "*.decimate.target_triangles_count",
                    ratio = "*.decimate.keep_ratio", smoothing = "*.smooth.iterations_count",
                    voxel = "resample.spacing_mm", felt = "haptic.spacing_mm", detail = "scene.triangles_ratio";
  const auto sweep = [](const char* name, std::vector<std::string> settings, std::vector<SweptParameter> values) {
    return TradeSweep{name, std::move(settings), std::move(values)};
  };
  TradePlan plan;
  // Neither decimated nor smoothed: the surface that the voxels define.
  plan.finest = {count + "=0", ratio + "=0", bound + "=0", smoothing + "=0"};
  plan.sweeps.push_back(sweep("bound", {}, {{bound, {"0.2", "0.3", "0.5", "0.8", "1.2"}}}));
  // Without the scene's limit on triangles, to show how far the scene's result is from what could be displayed.
  plan.sweeps.push_back(sweep("free", {count + "=0"}, {{bound, {"0.3"}}}));
  plan.sweeps.push_back(sweep("ratio", {count + "=0", bound + "=0"}, {{ratio, {"0.02", "0.05"}}}));
  // A machine that shows twice the triangles that the scene asks for, or half of them.
  plan.sweeps.push_back(sweep("detail", {}, {{detail, {"0.5", "2"}}, {bound, {"0.5", "1.2"}}}));
  plan.sweeps.push_back(sweep("smooth", {bound + "=0.3"}, {{smoothing, {"0", "5", "100"}}}));
  plan.sweeps.push_back(sweep("voxel", {}, {{voxel, {voxels(1), voxels(1.5), voxels(2)}}, {bound, {"0.8", "1.2"}}}));
  if (haptic)
    plan.sweeps.push_back(
        sweep("haptic", {bound + "=0.3"}, {{felt, {voxels(0.5), voxels(0.65), voxels(1), voxels(1.6)}}}));
  return plan;
}

TradePlan read_trade_plan(const std::filesystem::path& file) {
  const config::YamlNode tree = config::read_yaml(file);
  config::ConfigFaults faults;
  TradeFileParams said;
  const config::Places at =
      config::read_declared({file, faults, {}, {}}, tree, parameters_of<TradeFileParams>(), &said);
  TradePlan plan;
  plan.finest = config::settings_of(said.finest);
  for (const auto& [name, sweep] : said.sweeps) {
    const std::string where = "sweeps." + name;
    if (name == "finest") faults.add(file, at.at(where), where, "is the name of another point");
    TradeSweep one{name, config::settings_of(sweep.set), {}};
    for (const auto& [path, swept] : sweep.values) {
      SweptParameter parameter{path, {}};
      for (const config::SaidValue& value : swept.values) parameter.values.push_back(value.text);
      if (parameter.values.empty())
        faults.add(file, at.at(where), where + ".values." + path, "must be a list of values");
      one.values.push_back(std::move(parameter));
    }
    plan.sweeps.push_back(std::move(one));
  }
  faults.raise();
  return plan;
}

AnyParams trade_file_params() { return AnyParams::make<TradeFileParams>(); }

}  // namespace trephine::trade
