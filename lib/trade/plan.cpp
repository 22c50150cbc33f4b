// SPDX-License-Identifier: GPL-3.0-or-later
#include "trade/plan.h"

#include <set>

#include "pipeline/yaml_document.h"

namespace trephine {
namespace {

// As --set has it.
std::string text_of(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::list) return node.text;
  std::string text;
  for (const YamlNode& item : node.items) text += (text.empty() ? "" : ", ") + item.text;
  return "[" + text + "]";
}

bool is_value(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::scalar) return true;
  if (node.kind != YamlNode::Kind::list) return false;
  for (const YamlNode& item : node.items)
    if (item.kind != YamlNode::Kind::scalar) return false;
  return true;
}

std::vector<std::string> read_settings(const std::filesystem::path& file, const YamlNode& node,
                                       const std::string& where, ConfigFaults& faults) {
  std::vector<std::string> settings;
  for (const auto& [key, value] : node.entries)
    if (is_value(value))
      settings.push_back(key.text + "=" + text_of(value));
    else
      faults.add(file, value, where + "." + key.text, "must be a value, or a list of numbers");
  return settings;
}

TradeSweep read_sweep(const std::filesystem::path& file, const YamlNode& key, const YamlNode& node,
                      ConfigFaults& faults) {
  const std::string where = "sweeps." + key.text;
  TradeSweep sweep;
  sweep.name = key.text;
  if (!is_plain_name(key.text) || key.text == "finest")
    faults.add(file, key, where, "a name has letters a-z, digits and _ only, and is not finest");
  if (node.kind != YamlNode::Kind::map) {
    faults.add(file, node, where, "must hold keys and values");
    return sweep;
  }
  MapReader map(file, node, where, faults);
  if (const YamlNode* set = map.map("set")) sweep.settings = read_settings(file, *set, where + ".set", faults);
  const YamlNode* values = map.map("values");
  if (!node.find("values")) map.fault(node, "values", "is missing");
  map.finish();
  if (values)
    for (const auto& [path, list] : values->entries) {
      SweptParameter swept;
      swept.path = path.text;
      if (list.kind == YamlNode::Kind::list) {
        for (const YamlNode& item : list.items)
          if (is_value(item))
            swept.values.push_back(text_of(item));
          else
            faults.add(file, item, where + ".values." + path.text, "must be a value, or a list of numbers");
      }
      if (swept.values.empty()) faults.add(file, list, where + ".values." + path.text, "must be a list of values");
      sweep.values.push_back(std::move(swept));
    }
  return sweep;
}

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
  // Neither decimated nor smoothed: the surface as the voxels say it.
  plan.finest = {count + "=0", ratio + "=0", bound + "=0", smoothing + "=0"};
  plan.sweeps.push_back(sweep("bound", {}, {{bound, {"0.2", "0.3", "0.5", "0.8", "1.2"}}}));
  // Whatever the scene allows: how far that is from what could be shown.
  plan.sweeps.push_back(sweep("free", {count + "=0"}, {{bound, {"0.3"}}}));
  plan.sweeps.push_back(sweep("ratio", {count + "=0", bound + "=0"}, {{ratio, {"0.02", "0.05"}}}));
  // A machine that shows twice what the scene asks of it, or half.
  plan.sweeps.push_back(sweep("detail", {}, {{detail, {"0.5", "2"}}, {bound, {"0.5", "1.2"}}}));
  plan.sweeps.push_back(sweep("smooth", {bound + "=0.3"}, {{smoothing, {"0", "5", "100"}}}));
  plan.sweeps.push_back(sweep("voxel", {}, {{voxel, {voxels(1), voxels(1.5), voxels(2)}}, {bound, {"0.8", "1.2"}}}));
  if (haptic)
    plan.sweeps.push_back(
        sweep("haptic", {bound + "=0.3"}, {{felt, {voxels(0.5), voxels(0.65), voxels(1), voxels(1.6)}}}));
  return plan;
}

TradePlan read_trade_plan(const std::filesystem::path& file) {
  const YamlNode tree = read_yaml(file);
  ConfigFaults faults;
  MapReader map(file, tree, "", faults);
  const YamlNode* version = map.any("trephine");
  if (!version || version->text != "1")
    map.fault(version ? *version : tree, "trephine", "must be 1, the version of the configuration's format");
  TradePlan plan;
  if (const YamlNode* finest = map.map("finest")) plan.finest = read_settings(file, *finest, "finest", faults);
  const YamlNode* sweeps = map.map("sweeps");
  if (!tree.find("sweeps")) map.fault(tree, "sweeps", "is missing");
  if (sweeps)
    for (const auto& [key, node] : sweeps->entries) plan.sweeps.push_back(read_sweep(file, key, node, faults));
  map.finish();
  faults.raise();
  return plan;
}

}  // namespace trephine
