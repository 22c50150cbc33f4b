// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace trephine {

/// One way to make a case that `trephine trade` measured: settings, and what they gave. Times are of the machine that
/// measured; deviations are of all anatomies together (the worst one's), two-sided, to the finest result of the sweep.
struct TradePoint {
  std::string name;
  std::vector<std::string> settings;  ///< "path=value", as --set has it
  double seconds = 0;                 ///< of all stages, each alone
  double peak_memory_mb = 0;          ///< of the stage that needs most, alone
  std::int64_t triangles_count = 0, bytes = 0;
  double deviation_max_mm = 0, deviation_p99_mm = 0, deviation_rms_mm = 0;
  std::string refused;  ///< why it makes no case; then the figures mean nothing. Empty: it makes one

  bool operator==(const TradePoint& other) const { return name == other.name; }
};

enum class TradeCost { seconds, triangles, bytes };
enum class TradeError { max, p99, rms };
const char* to_text(TradeCost cost);
const char* to_text(TradeError error);
double cost_of(const TradePoint& point, TradeCost cost);
double error_of(const TradePoint& point, TradeError error);

/// The numbers of the points that no other beats in both (Pareto), cheapest first; of equal ones the first. A cost that
/// was not measured, or an error of a refused point, is no point of the front.
std::vector<std::size_t> pareto_front(const std::vector<TradePoint>& points, TradeCost cost, TradeError error);

/// What a configuration asks of a front; 0 and empty ask nothing.
struct TradeRule {
  double max_deviation_mm = 0, p99_deviation_mm = 0, rms_deviation_mm = 0;  ///< accuracy
  double seconds = 0;                                                       ///< budget
  std::int64_t triangles_count = 0, bytes = 0;
  std::string profile;  ///< draft, standard or fine
  bool empty() const;
  /// "max_deviation_mm 0.3, triangles 200000"
  std::string text() const;
};

/// The profiles, each a point of the front of seconds against RMS deviation, by the front's own shape: draft is its
/// fastest; standard its knee, the point farthest below the line from its fastest to its most accurate in logarithmic
/// axes [Satopaa2011], or where none is its most accurate; both among the points within the scene's own triangles
/// (scene.triangles_ratio at most 1). fine is the most accurate of all.
constexpr const char* profile_names[] = {"draft", "standard", "fine"};

struct TradeChoice {
  TradePoint point;
  std::string why;  ///< one line
};

/// With accuracy asked for, the fastest point on the scan's own voxels that keeps it and the budget (what resampling
/// costs is no promise for another scan); with a budget alone, the one of least RMS deviation within it; of equal ones
/// the one with fewer triangles, then the first. Points of more triangles than the scene says (scene.triangles_ratio
/// above 1) are chosen only under a budget of triangles. Throws Error 80 naming the nearest that there is where none
/// fits, 78 where a profile is unknown.
TradeChoice choose(const std::vector<TradePoint>& points, const TradeRule& rule);

/// What holds for every head of several sweeps: the points that all of them hold with the same settings, in the first
/// one's order, each with the worst of their figures. Refused in one, it is refused.
std::vector<TradePoint> points_of_all(const std::vector<std::vector<TradePoint>>& sweeps);

/// The points of a trade.json. Throws 66 where it cannot be read, 65 naming the field where it is none of ours.
std::vector<TradePoint> read_trade_points(const std::filesystem::path& file);
/// The member "points" of a trade.json, and what read_trade_points reads of it.
std::string trade_points_json(const std::vector<TradePoint>& points);
constexpr const char* trade_format = "trephine.trade";
constexpr int trade_format_version = 1;

}  // namespace trephine
