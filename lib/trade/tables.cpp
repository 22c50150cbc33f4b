// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "base/joined.h"
#include "base/parallel.h"
#include "base/text.h"
#include "base/text_table.h"
#include "trade/trade.h"

namespace trephine::trade {
namespace {

using Json = nlohmann::ordered_json;

constexpr config::TradeCost all_costs[] = {config::TradeCost::seconds, config::TradeCost::triangles,
                                           config::TradeCost::bytes};
constexpr config::TradeError all_errors[] = {config::TradeError::rms, config::TradeError::p99, config::TradeError::max};

// Names of the points on a front, made of the points that may be chosen.
std::vector<std::string> front_names(const std::vector<config::TradePoint>& points, config::TradeCost cost,
                                     config::TradeError error) {
  std::vector<std::string> names;
  for (const std::size_t i : config::pareto_front(points, cost, error)) names.push_back(points[i].name);
  return names;
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string number(double v) { return to_text(ParameterValue(v)); }

// The stage without its anatomy, such as "decimate" of "skull.decimate"; the full name for stages of the whole case.
std::string step_of(const std::string& stage, const std::string& anatomy) {
  return stage.rfind(anatomy + ".", 0) == 0 ? stage.substr(anatomy.size() + 1) : std::string();
}

Json to_json(const TradeDeviation& d) {
  return {{"rms_mm", d.rms_mm},
          {"p99_mm", d.p99_mm},
          {"max_mm", d.max_mm},
          {"to_reference_max_mm", d.to_reference_max_mm},
          {"from_reference_max_mm", d.from_reference_max_mm},
          {"to_reference_rms_mm", d.to_reference_rms_mm},
          {"from_reference_rms_mm", d.from_reference_rms_mm}};
}

Json details_of(const PointTrade& p) {
  Json out;
  out["name"] = p.total.name;
  out["sweep"] = p.planned.sweep;
  if (!p.beyond_scene.empty()) out["beyond_scene"] = p.beyond_scene;
  for (const StageTrade& s : p.stages)
    out["stages"][s.name] = {{"median_s", s.median_s}, {"spread_s", s.spread_s}, {"peak_memory_mb", s.peak_memory_mb}};
  for (const AnatomyTrade& a : p.anatomies) {
    Json& anatomy = out["anatomies"][a.name];
    anatomy = {{"triangles_count", a.triangles_count},
               {"bytes", a.bytes},
               {"volume_ml", a.volume_ml},
               {"volume_change_percent", a.volume_change_percent},
               {"to_finest", to_json(a.to_finest)}};
    if (a.to_truth) anatomy["to_truth"] = to_json(*a.to_truth);
    if (a.dice_ratio) anatomy["dice_ratio"] = *a.dice_ratio;
    if (a.mismatch_rms_mm) anatomy["mismatch_rms_mm"] = *a.mismatch_rms_mm;
  }
  for (const ShapeTrade& s : p.shapes)
    out["shapes"][s.name] = {{"sub_voxel_rms_mm", s.sub_voxel_rms_mm},
                             {"sub_voxel_p99_mm", s.sub_voxel_p99_mm},
                             {"nearest_rms_mm", s.nearest_rms_mm},
                             {"nearest_p99_mm", s.nearest_p99_mm},
                             {"missed_ratio", s.missed_ratio}};
  return out;
}

}  // namespace

std::string trade_csv(const TradeResult& result) {
  std::set<std::string> steps, case_stages;
  std::set<std::string> anatomies;
  for (const PointTrade& p : result.points)
    for (const AnatomyTrade& a : p.anatomies) anatomies.insert(a.name);
  for (const PointTrade& p : result.points)
    for (const StageTrade& s : p.stages) {
      const std::size_t dot = s.name.find('.');
      const bool of_anatomy = dot != std::string::npos && anatomies.count(s.name.substr(0, dot));
      if (of_anatomy) steps.insert(s.name.substr(dot + 1));
    }
  std::string text =
      "point,sweep,settings,anatomy,refused,beyond_scene,on_front,seconds,spread_s,peak_memory_mb,triangles_count,"
      "bytes,volume_ml,volume_change_percent,finest_rms_mm,finest_p99_mm,finest_max_mm,finest_there_max_mm,"
      "finest_back_max_mm,truth_rms_mm,truth_p99_mm,truth_max_mm,truth_there_max_mm,truth_back_max_mm,dice_ratio,"
      "mismatch_rms_mm,felt_rms_mm,felt_nearest_rms_mm";
  for (const std::string& s : steps) text += "," + s + "_s";
  text += '\n';
  const auto choosable = result.choosable();
  const auto front = front_names(choosable, config::TradeCost::seconds, config::TradeError::rms);
  const auto is_on_front = [&](const std::string& name) {
    return std::find(front.begin(), front.end(), name) != front.end();
  };
  for (const PointTrade& p : result.points) {
    const std::string head =
        csv_text(p.total.name) + "," + p.planned.sweep + "," + csv_text(joined(p.planned.settings, "; ")) + ",";
    const std::string tail = "," + csv_text(p.total.refused) + "," + csv_text(p.beyond_scene) + "," +
                             (is_on_front(p.total.name) ? "1" : "0");
    const std::string no_steps(steps.size(), ',');
    if (!p.total.refused.empty()) {
      text += head + "case" + tail + std::string(21, ',') + no_steps + "\n";
      continue;
    }
    double spread_s = 0;
    for (const StageTrade& s : p.stages) spread_s += s.spread_s;
    const config::TradePoint& t = p.total;
    text += head + "case" + tail +
            fmt::format(",{},{},{},{},{},,,{},{},{},,,,,,,,,,,", number(t.seconds), number(spread_s),
                        number(t.peak_memory_mb), t.triangles_count, t.bytes, number(t.deviation_rms_mm),
                        number(t.deviation_p99_mm), number(t.deviation_max_mm)) +
            no_steps + "\n";
    const auto felt = [&](const std::string& name) {
      for (const ShapeTrade& s : p.shapes)
        if (s.name == name) return number(s.sub_voxel_rms_mm) + "," + number(s.nearest_rms_mm);
      return std::string(",");
    };
    for (const AnatomyTrade& a : p.anatomies) {
      double seconds = 0, spread = 0, peak = 0;
      std::map<std::string, double> by_step;
      for (const StageTrade& s : p.stages)
        if (const std::string step = step_of(s.name, a.name); !step.empty()) {
          seconds += s.median_s;
          spread += s.spread_s;
          peak = std::max(peak, s.peak_memory_mb);
          by_step[step] = s.median_s;
        }
      const auto deviation = [](const TradeDeviation& d) {
        return number(d.rms_mm) + "," + number(d.p99_mm) + "," + number(d.max_mm) + "," +
               number(d.to_reference_max_mm) + "," + number(d.from_reference_max_mm);
      };
      text += head + a.name + tail +
              fmt::format(",{},{},{},{},{},{},{},{},{},{},{},{}", number(seconds), number(spread), number(peak),
                          a.triangles_count, a.bytes, number(a.volume_ml), number(a.volume_change_percent),
                          deviation(a.to_finest), a.to_truth ? deviation(*a.to_truth) : ",,,,",
                          a.dice_ratio ? number(*a.dice_ratio) : "",
                          a.mismatch_rms_mm ? number(*a.mismatch_rms_mm) : "", felt(a.name));
      for (const std::string& s : steps) text += "," + (by_step.count(s) ? number(by_step[s]) : std::string());
      text += '\n';
    }
    // Felt shapes that have no surface of their own.
    for (const ShapeTrade& s : p.shapes)
      if (std::none_of(p.anatomies.begin(), p.anatomies.end(), [&](const AnatomyTrade& a) { return a.name == s.name; }))
        text += head + s.name + tail + std::string(19, ',') + "," + number(s.sub_voxel_rms_mm) + "," +
                number(s.nearest_rms_mm) + no_steps + "\n";
  }
  return text;
}

std::string trade_json(const TradeResult& result, const std::string& program_version) {
  Json json;
  json["format"] = config::trade_format;
  json["version"] = config::trade_format_version;
  json["program"] = "trephine " + program_version;
  json["threads_count"] = thread_count();
  json["calibration_s"] = result.calibration_s;
  json["recipe_sha256"] = result.recipe_sha256;
  const auto choosable = result.choosable();
  // Only points that may be chosen; the others stand in details alone.
  json["points"] = Json::parse(config::trade_points_json(choosable));
  for (const config::TradeCost cost : all_costs)
    for (const config::TradeError error : all_errors)
      json["fronts"][std::string(config::to_text(cost)) + "_" + config::to_text(error)] =
          front_names(choosable, cost, error);
  if (!choosable.empty())
    for (const std::string& profile : config::profile_names) try {
        config::TradeRule rule;
        rule.profile = profile;
        json["profiles"][profile] = config::choose(choosable, rule).point.name;
      } catch (const Error&) {  // there is no point but the finest
      }
  json["details"] = Json::array();
  for (const PointTrade& p : result.points) {
    Json details = details_of(p);
    if (!p.total.refused.empty()) details["refused"] = p.total.refused;
    json["details"].push_back(std::move(details));
  }
  return json.dump(1) + "\n";
}

std::string trade_table(const TradeResult& result) {
  const auto choosable = result.choosable();
  std::vector<std::vector<std::string>> rows = {
      {"point", "s", "MB peak", "triangles", "MB", "RMS mm", "p99 mm", "max mm", "truth RMS mm", "", ""}};
  const auto front = front_names(choosable, config::TradeCost::seconds, config::TradeError::rms);
  std::map<std::string, std::string> profile_of;
  for (const std::string& profile : config::profile_names) try {
      config::TradeRule rule;
      rule.profile = profile;
      std::string& names = profile_of[config::choose(choosable, rule).point.name];
      names += (names.empty() ? "" : ", ") + profile;
    } catch (const Error&) {  // there is no point but the finest
    }
  for (const PointTrade& p : result.points) {
    if (!p.total.refused.empty()) {
      rows.push_back({p.total.name, "", "", "", "", "", "", "", "", "refused", ""});
      continue;
    }
    double truth_rms_mm = 0;
    for (const AnatomyTrade& a : p.anatomies)
      if (a.to_truth) truth_rms_mm = std::max(truth_rms_mm, a.to_truth->rms_mm);
    const bool on_front = std::find(front.begin(), front.end(), p.total.name) != front.end();
    const auto profile = profile_of.find(p.total.name);
    rows.push_back({p.total.name, fmt::format("{:.1f}", p.total.seconds), fmt::format("{:.0f}", p.total.peak_memory_mb),
                    grouped_text(p.total.triangles_count), fmt::format("{:.1f}", double(p.total.bytes) / 1e6),
                    fmt::format("{:.4f}", p.total.deviation_rms_mm), fmt::format("{:.3f}", p.total.deviation_p99_mm),
                    fmt::format("{:.3f}", p.total.deviation_max_mm),
                    result.has_truth ? fmt::format("{:.4f}", truth_rms_mm) : "",
                    !p.beyond_scene.empty() ? "beyond the scene"
                    : on_front              ? "front"
                                            : "",
                    profile == profile_of.end() ? "" : profile->second});
  }
  std::string text = text_table(rows, "lr");
  for (const PointTrade& p : result.points)
    if (!p.total.refused.empty()) text += p.total.name + ": refused: " + p.total.refused + "\n";
  return text;
}

}  // namespace trephine::trade
