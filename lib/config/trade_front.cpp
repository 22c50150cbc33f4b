// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/trade_front.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/params.h"
#include "base/refusal.h"
#include "base/text.h"
#include "base/write_file.h"

namespace trephine::config {
namespace {

using Json = nlohmann::ordered_json;

std::string number(double v) { return trephine::to_text(ParameterValue(v)); }

double infinite() { return std::numeric_limits<double>::infinity(); }

// How far a point is from keeping a rule: 0 where it keeps it, else how far it exceeds the limit that it exceeds most.
double excess(const TradePoint& p, const TradeRule& rule) {
  double worst = 0;
  const auto hold = [&](double value, double limit) {
    if (limit > 0) worst = std::max(worst, value / limit - 1);
  };
  hold(p.deviation_max_mm, rule.max_deviation_mm);
  hold(p.deviation_p99_mm, rule.p99_deviation_mm);
  hold(p.deviation_rms_mm, rule.rms_deviation_mm);
  hold(p.seconds, rule.seconds);
  hold(double(p.triangles_count), double(rule.triangles_count));
  hold(double(p.bytes), double(rule.bytes));
  return worst;
}

// The limits of a rule that a point exceeds, as the configuration must say them to find it: rounded up to three digits.
std::string limits_that_keep(const TradePoint& p, const TradeRule& rule) {
  std::string text;
  const auto hold = [&](const char* name, double value, double limit) {
    if (limit <= 0 || value <= limit) return;
    const double unit = std::pow(10, std::floor(std::log10(value)) - 2);
    text += (text.empty() ? "`" : " and `") + std::string(name) + "` to " + number(std::ceil(value / unit) * unit);
  };
  hold("accuracy.max_deviation_mm", p.deviation_max_mm, rule.max_deviation_mm);
  hold("accuracy.p99_deviation_mm", p.deviation_p99_mm, rule.p99_deviation_mm);
  hold("accuracy.rms_deviation_mm", p.deviation_rms_mm, rule.rms_deviation_mm);
  hold("budget.seconds", p.seconds, rule.seconds);
  hold("budget.triangles", double(p.triangles_count), double(rule.triangles_count));
  hold("budget.bytes", double(p.bytes), double(rule.bytes));
  return text;
}

// The cost of voxels other than the scan's differs from scan to scan, and a run cannot see it: what was 0.17 mm RMS on
// one head was 0.44 mm on another.
bool keeps_voxels(const TradePoint& p) {
  return std::none_of(p.settings.begin(), p.settings.end(),
                      [](const std::string& s) { return s.rfind("resample.", 0) == 0; });
}

// The machine may not be able to show more triangles than the scene allows, so a point with more is chosen only on
// request.
bool is_within_scene(const TradePoint& p) {
  const std::string path = "scene.triangles_ratio=";
  return std::none_of(p.settings.begin(), p.settings.end(), [&](const std::string& s) {
    return s.rfind(path, 0) == 0 && parse_number(s.substr(path.size())).value_or(0) > 1;
  });
}

void take_worse(TradePoint& p, const TradePoint& other) {
  if (p.refused.empty()) p.refused = other.refused;
  p.seconds = std::max(p.seconds, other.seconds);
  p.peak_memory_mb = std::max(p.peak_memory_mb, other.peak_memory_mb);
  p.triangles_count = std::max(p.triangles_count, other.triangles_count);
  p.bytes = std::max(p.bytes, other.bytes);
  p.deviation_max_mm = std::max(p.deviation_max_mm, other.deviation_max_mm);
  p.deviation_p99_mm = std::max(p.deviation_p99_mm, other.deviation_p99_mm);
  p.deviation_rms_mm = std::max(p.deviation_rms_mm, other.deviation_rms_mm);
}

std::string figures(const TradePoint& p) {
  return number(std::round(p.seconds * 10) / 10) + " s, " + std::to_string(p.triangles_count) +
         " triangles, deviation " + number(std::round(p.deviation_max_mm * 1e4) / 1e4) + " mm at most, " +
         number(std::round(p.deviation_rms_mm * 1e4) / 1e4) + " mm RMS";
}

// The knee of the front: in logarithmic axes, the point farthest below the line from the first point to the last; where
// there is none, the last point. Points that lose accuracy and gain little time are for those who ask for a draft.
std::size_t knee_of(const std::vector<TradePoint>& points, const std::vector<std::size_t>& front) {
  const auto x = [&](std::size_t i) { return std::log(std::max(points[front[i]].seconds, 1e-6)); };
  const auto y = [&](std::size_t i) { return std::log(std::max(points[front[i]].deviation_rms_mm, 1e-6)); };
  const std::size_t last = front.size() - 1;
  const double dx = x(last) - x(0), dy = y(last) - y(0);
  std::size_t best = last;
  double deepest = 0;
  for (std::size_t i = 1; i < last; ++i) {
    const double below = dx * (y(0) - y(i)) - dy * (x(0) - x(i));
    if (below > deepest) deepest = below, best = i;
  }
  return best;
}

TradeChoice choose_profile(const std::vector<TradePoint>& points, const std::string& profile) {
  std::vector<TradePoint> measured;
  // The finest result deviates from itself by 0, which has no place on logarithmic axes.
  for (const TradePoint& p : points)
    if (p.deviation_rms_mm > 0 && (profile == "fine" || is_within_scene(p))) measured.push_back(p);
  const auto front = pareto_front(measured, TradeCost::seconds, TradeError::rms);
  if (front.empty())
    throw refusal("profile", "the front has no point", {"measure one with `trade`, or leave `profile` out"});
  const std::size_t knee = knee_of(measured, front);
  const std::string of = " of " + std::to_string(front.size()) + " on the front of seconds against RMS deviation: ";
  if (profile == "draft") return {measured[front.front()], "the fastest" + of + figures(measured[front.front()])};
  if (profile == "fine") return {measured[front.back()], "the most accurate" + of + figures(measured[front.back()])};
  if (profile == "standard") return {measured[front[knee]], "the knee" + of + figures(measured[front[knee]])};
  throw Error(ExitCode::bad_config, "", "profile", profile + ", must be draft, standard or fine");
}

}  // namespace

const char* to_text(TradeCost cost) {
  switch (cost) {
    case TradeCost::seconds:
      return "seconds";
    case TradeCost::triangles:
      return "triangles";
    case TradeCost::bytes:
      return "bytes";
  }
  return "";
}

const char* to_text(TradeError error) {
  switch (error) {
    case TradeError::max:
      return "max";
    case TradeError::p99:
      return "p99";
    case TradeError::rms:
      return "rms";
  }
  return "";
}

double cost_of(const TradePoint& p, TradeCost cost) {
  switch (cost) {
    case TradeCost::seconds:
      return p.seconds;
    case TradeCost::triangles:
      return double(p.triangles_count);
    case TradeCost::bytes:
      return double(p.bytes);
  }
  return 0;
}

double error_of(const TradePoint& p, TradeError error) {
  switch (error) {
    case TradeError::max:
      return p.deviation_max_mm;
    case TradeError::p99:
      return p.deviation_p99_mm;
    case TradeError::rms:
      return p.deviation_rms_mm;
  }
  return 0;
}

std::vector<std::size_t> pareto_front(const std::vector<TradePoint>& points, TradeCost cost, TradeError error) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].refused.empty() && std::isfinite(cost_of(points[i], cost)) &&
        std::isfinite(error_of(points[i], error)))
      order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const double ca = cost_of(points[a], cost), cb = cost_of(points[b], cost);
    return ca != cb ? ca < cb : error_of(points[a], error) < error_of(points[b], error);
  });
  std::vector<std::size_t> front;
  double least = infinite();
  for (const std::size_t i : order)
    if (error_of(points[i], error) < least) {
      least = error_of(points[i], error);
      front.push_back(i);
    }
  return front;
}

bool TradeRule::empty() const { return text().empty(); }

std::string TradeRule::text() const {
  std::string text;
  const auto add = [&](const char* name, const std::string& value) {
    text += (text.empty() ? "" : ", ") + std::string(name) + " " + value;
  };
  if (!profile.empty()) add("profile", profile);
  if (max_deviation_mm > 0) add("max_deviation_mm", number(max_deviation_mm));
  if (p99_deviation_mm > 0) add("p99_deviation_mm", number(p99_deviation_mm));
  if (rms_deviation_mm > 0) add("rms_deviation_mm", number(rms_deviation_mm));
  if (seconds > 0) add("seconds", number(seconds));
  if (triangles_count > 0) add("triangles", std::to_string(triangles_count));
  if (bytes > 0) add("bytes", std::to_string(bytes));
  return text;
}

TradeChoice choose(const std::vector<TradePoint>& points, const TradeRule& rule) {
  if (!rule.profile.empty()) return choose_profile(points, rule.profile);
  const bool accuracy = rule.max_deviation_mm > 0 || rule.p99_deviation_mm > 0 || rule.rms_deviation_mm > 0;
  const auto better = [&](const TradePoint& a, const TradePoint& b) {
    const double first_a = accuracy ? a.seconds : a.deviation_rms_mm,
                 first_b = accuracy ? b.seconds : b.deviation_rms_mm;
    return first_a != first_b ? first_a < first_b : a.triangles_count < b.triangles_count;
  };
  const TradePoint *best = nullptr, *nearest = nullptr;
  std::size_t keep = 0;
  for (const TradePoint& p : points) {
    if (!p.refused.empty() || (accuracy && !keeps_voxels(p))) continue;
    if (rule.triangles_count == 0 && !is_within_scene(p)) continue;
    if (!nearest || excess(p, rule) < excess(*nearest, rule)) nearest = &p;
    if (excess(p, rule) > 0) continue;
    ++keep;
    if (!best || better(p, *best)) best = &p;
  }
  if (!best)
    throw refusal(
        "trade",
        "no point of the front keeps " + rule.text() +
            (nearest ? "; the nearest is " + nearest->name + ": " + figures(*nearest) : ""),
        {nearest ? "set " + limits_that_keep(*nearest, rule) + ", which finds that point, or choose a `profile`"
                 : "measure a front with `trade`, or choose a `profile`"});
  return {*best, std::string(accuracy ? "the fastest" : "the most accurate") + " of " + std::to_string(keep) + " of " +
                     std::to_string(points.size()) + " points that keep " + rule.text() + ": " + figures(*best)};
}

std::vector<TradePoint> points_of_all(const std::vector<std::vector<TradePoint>>& sweeps) {
  if (sweeps.empty()) return {};
  std::vector<TradePoint> all = sweeps[0];
  for (std::size_t i = 1; i < sweeps.size(); ++i) {
    std::vector<TradePoint> both;
    for (TradePoint& p : all)
      for (const TradePoint& other : sweeps[i])
        if (other.settings == p.settings) {
          take_worse(p, other);
          both.push_back(std::move(p));
          break;
        }
    all = std::move(both);
  }
  return all;
}

std::string trade_points_json(const std::vector<TradePoint>& points) {
  Json json = Json::array();
  for (const TradePoint& p : points) {
    Json point;
    point["name"] = p.name;
    point["settings"] = p.settings;
    if (!p.refused.empty()) {
      point["refused"] = p.refused;
    } else {
      point["seconds"] = p.seconds;
      point["peak_memory_mb"] = p.peak_memory_mb;
      point["triangles_count"] = p.triangles_count;
      point["bytes"] = p.bytes;
      point["deviation_max_mm"] = p.deviation_max_mm;
      point["deviation_p99_mm"] = p.deviation_p99_mm;
      point["deviation_rms_mm"] = p.deviation_rms_mm;
    }
    json.push_back(std::move(point));
  }
  return json.dump();
}

TradeFront read_trade_front(const std::filesystem::path& file) {
  constexpr std::uint64_t max_bytes = 64 << 20;
  const std::vector<char> bytes = read_file(file, max_bytes);
  const auto fault = [&](const std::string& field, const std::string& what) {
    return Error(ExitCode::bad_input, file.string(), field, what);
  };
  const Json json = Json::parse(bytes.begin(), bytes.end(), nullptr, false);
  if (!json.is_object() || !json.contains("format") || json["format"] != trade_format)
    throw fault("format", "is not a result of `trephine trade`");
  if (!json.contains("version") || json["version"] != trade_format_version)
    throw fault("version", "must be " + std::to_string(trade_format_version));
  if (!json.contains("points") || !json["points"].is_array()) throw fault("points", "is missing");
  TradeFront front;
  if (json.contains("recipe_sha256")) {
    if (!json["recipe_sha256"].is_string()) throw fault("recipe_sha256", "is not a text");
    front.recipe_sha256 = json["recipe_sha256"].get<std::string>();
  }
  if (json.contains("calibration_s")) {
    if (!json["calibration_s"].is_number()) throw fault("calibration_s", "is not a number");
    front.calibration_s = json["calibration_s"].get<double>();
    if (!(front.calibration_s > 0)) throw fault("calibration_s", "must be above 0");
  }
  std::vector<TradePoint>& points = front.points;
  for (std::size_t i = 0; i < json["points"].size(); ++i) try {
      const Json& from = json["points"][i];
      TradePoint p;
      p.name = from.at("name").get<std::string>();
      p.settings = from.at("settings").get<std::vector<std::string>>();
      p.refused = from.value("refused", "");
      if (p.refused.empty()) {
        p.seconds = from.at("seconds").get<double>();
        p.peak_memory_mb = from.at("peak_memory_mb").get<double>();
        p.triangles_count = from.at("triangles_count").get<std::int64_t>();
        p.bytes = from.at("bytes").get<std::int64_t>();
        p.deviation_max_mm = from.at("deviation_max_mm").get<double>();
        p.deviation_p99_mm = from.at("deviation_p99_mm").get<double>();
        p.deviation_rms_mm = from.at("deviation_rms_mm").get<double>();
      }
      points.push_back(std::move(p));
    } catch (const Json::exception&) {
      throw fault("points[" + std::to_string(i) + "]", "a member is missing or of the wrong kind");
    }
  if (points.empty()) throw fault("points", "is empty");
  return front;
}

std::vector<std::vector<TradePoint>> on_one_machine(const std::vector<TradeFront>& fronts) {
  std::vector<std::vector<TradePoint>> sweeps;
  for (const TradeFront& front : fronts) {
    sweeps.push_back(front.points);
    if (front.calibration_s > 0 && fronts[0].calibration_s > 0)
      for (TradePoint& p : sweeps.back()) p.seconds *= fronts[0].calibration_s / front.calibration_s;
  }
  return sweeps;
}

std::string why_stale(const TradeFront& front, const std::filesystem::path& file, const std::string& recipe_sha256) {
  if (front.recipe_sha256 == recipe_sha256) return "";
  return file.filename().string() +
         (front.recipe_sha256.empty() ? " does not say of which recipe it is" : " was measured with another recipe") +
         " and is not used: measure it anew with `trephine trade`";
}

}  // namespace trephine::config
