// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace trephine::config {

/// One way to make a case that `trephine trade` measured: the settings and the resulting figures. Times are those of
/// the machine that measured. Deviations are two-sided, measured to the finest result of the sweep; the worst anatomy
/// counts.
struct TradePoint {
  std::string name;
  std::vector<std::string> settings;  ///< "path=value", as --set takes it
  double seconds = 0;                 ///< of all stages, each timed alone
  double peak_memory_mb = 0;          ///< of the stage that needs most, measured alone
  std::int64_t triangles_count = 0, bytes = 0;
  double deviation_max_mm = 0, deviation_p99_mm = 0, deviation_rms_mm = 0;
  std::string refused;  ///< why the point makes no case; its figures then mean nothing. Empty: it makes one

  bool operator==(const TradePoint& other) const { return name == other.name; }
};

enum class TradeCost { seconds, triangles, bytes };
enum class TradeError { max, p99, rms };
const char* to_text(TradeCost cost);
const char* to_text(TradeError error);
double cost_of(const TradePoint& point, TradeCost cost);
double error_of(const TradePoint& point, TradeError error);

/// The numbers of the points of the Pareto front, which no other point beats in both cost and error. The cheapest comes
/// first; of equal points the first is taken. A point whose cost was not measured or that was refused is not on the
/// front.
std::vector<std::size_t> pareto_front(const std::vector<TradePoint>& points, TradeCost cost, TradeError error);

/// What a configuration asks of a front; 0 and empty mean no condition.
struct TradeRule {
  double max_deviation_mm = 0, p99_deviation_mm = 0, rms_deviation_mm = 0;  ///< accuracy
  double seconds = 0;                                                       ///< budget
  std::int64_t triangles_count = 0, bytes = 0;
  std::string profile;  ///< draft, standard or fine
  bool empty() const;
  /// A text such as "max_deviation_mm 0.3, triangles 200000".
  std::string text() const;
};

/// The profiles. Each is a point of the front of seconds against RMS deviation and follows from the front's own shape.
/// draft is the fastest point. standard is the knee: the point farthest below the line from the fastest to the most
/// accurate point in logarithmic axes [Satopaa2011], or where there is none, the most accurate point. Both are chosen
/// among the points within the scene's own triangles (scene.triangles_ratio at most 1). fine is the most accurate point
/// of all.
inline const std::vector<std::string> profile_names{"draft", "standard", "fine"};

struct TradeChoice {
  TradePoint point;
  std::string why;  ///< one line
};

/// Chooses a point. If an accuracy is asked for, it is the fastest point on the scan's own voxels that keeps the
/// accuracy and the budget (points on other voxels are left out, because the cost of resampling differs from scan to
/// scan). With a budget alone it is the point of least RMS deviation within the budget. Of equal points it is the one
/// with fewer triangles, then the first. Points with more triangles than the scene allows (scene.triangles_ratio above
/// 1) are chosen only under a budget of triangles. Throws Error 80, naming the nearest point, where none fits, and 78
/// where a profile is unknown.
TradeChoice choose(const std::vector<TradePoint>& points, const TradeRule& rule);

/// The points that hold for every head of several sweeps: those that all sweeps contain with the same settings, in the
/// order of the first sweep, each with the worst of its figures. A point that is refused in one sweep is refused.
std::vector<TradePoint> points_of_all(const std::vector<std::vector<TradePoint>>& sweeps);

/// What a trade.json holds for a rule.
struct TradeFront {
  std::string recipe_sha256;  ///< of the recipe that was measured (CaseConfig); empty: the file does not say
  double calibration_s = 0;   ///< calibration_seconds() of the machine that measured it; 0: the file does not say
  std::vector<TradePoint> points;
};
/// The fronts' points, their seconds as the machine of the first front would have taken them, where both files say
/// their machine's calibration_s.
std::vector<std::vector<TradePoint>> on_one_machine(const std::vector<TradeFront>& fronts);

/// Throws Error 66 where the file cannot be read, 65 naming the field where it is not a trade.json of ours.
TradeFront read_trade_front(const std::filesystem::path& file);
/// Why a front says nothing of that recipe, in a line; empty where it does.
std::string why_stale(const TradeFront& front, const std::filesystem::path& file, const std::string& recipe_sha256);
/// The member "points" of a trade.json, as read_trade_front reads it.
std::string trade_points_json(const std::vector<TradePoint>& points);
constexpr const char* trade_format = "trephine.trade";
constexpr int trade_format_version = 1;

}  // namespace trephine::config
