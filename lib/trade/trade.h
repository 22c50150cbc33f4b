// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/params.h"
#include "config/config.h"
#include "config/trade_front.h"
#include "trade/plan.h"

namespace trephine::trade {

struct TradeParams {
  int repeats_count = 3;
  double max_repeat_s = 5;
  int sample_count = 100000;
  std::int64_t cache_limit_mb = 32768;
  bool allow_external = false;
  template <class V>
  static void describe(V& v) {
    using P = TradeParams;
    v.integer(&P::repeats_count, "repeats_count", Range{1, 100},
              "How often each stage is timed; the median and the spread are reported.");
    v.number(
        &P::max_repeat_s, "max_repeat_s", Range{0, 1e6},
        "A stage is not timed again once its repeats together took this long; the times of long stages vary little.");
    v.integer(&P::sample_count, "sample_count", Range{1000, 100000000},
              "Points on each surface from which RMS and p99 are computed.");
    v.integer(&P::cache_limit_mb, "cache_limit_mb", Range{0, 1e9},
              "Largest size of the stages' outputs on disk after the sweep, in MB; the oldest go first.");
    v.flag(&P::allow_external, "allow_external",
           "Allow the stage external to run the programs that the recipe names, as for `run`.");
  }
};

struct TradeRequest {
  std::filesystem::path config;
  std::filesystem::path plan;   ///< empty: standard_plan
  std::filesystem::path out;    ///< folder of the results, and in .trade/ of what a stopped sweep needs to continue
  std::filesystem::path truth;  ///< truth.json of a phantom; empty: there is none
  config::ConfigOverrides overrides;
  TradeParams params;
  std::string program_version;
};

/// RMS, p99 and max of both directions together, and the max of each direction.
struct TradeDeviation {
  double rms_mm = 0, p99_mm = 0, max_mm = 0, to_reference_max_mm = 0, from_reference_max_mm = 0;
  double to_reference_rms_mm = 0, from_reference_rms_mm = 0;
};

/// What a point made of one anatomy that the scene shows.
struct AnatomyTrade {
  std::string name;
  std::int64_t triangles_count = 0, bytes = 0;
  double volume_ml = 0, volume_change_percent = 0;  ///< compared with the finest result's
  TradeDeviation to_finest;
  std::optional<TradeDeviation> to_truth;
  std::optional<double> dice_ratio;       ///< between its field and the truth, on the voxels of the point
  std::optional<double> mismatch_rms_mm;  ///< the felt surface against the displayed one
};

/// What a point made of one shape that can be felt in the scene: how far its surface in the haptic volume lies from the
/// finest result's unreduced surface.
struct ShapeTrade {
  std::string name;
  double sub_voxel_rms_mm = 0, sub_voxel_p99_mm = 0, nearest_rms_mm = 0, nearest_p99_mm = 0;
  double missed_ratio = 0;  ///< share of that surface along whose normals nothing is felt
};

struct StageTrade {
  std::string name;  ///< name in the graph, or "publish": making and checking the case's files
  double median_s = 0, spread_s = 0, peak_memory_mb = 0;
};

struct PointTrade {
  PlannedPoint planned;
  config::TradePoint total;
  std::string beyond_scene;  ///< the limit of the scene that it exceeds; such a point is measured but never chosen
  std::vector<StageTrade> stages;
  std::vector<AnatomyTrade> anatomies;
  std::vector<ShapeTrade> shapes;
};

struct TradeResult {
  std::vector<PointTrade> points;  ///< as planned
  std::string recipe_sha256;       ///< of the recipe that was measured
  std::vector<std::string> stale;  ///< a line for each front of the configuration that belongs to another recipe
  double calibration_s = 0;        ///< calibration_seconds() of the machine that measured last, after it did
  bool has_truth = false;
  int measured_count = 0;  ///< stages, files and comparisons that were not known yet
  /// The points that may be chosen: neither refused nor beyond the scene's limits.
  std::vector<config::TradePoint> choosable() const;
};

/// Called with the point and the count of points, the current work and how far it is.
using TradeObserver = std::function<void(std::size_t point, std::size_t count, const std::string& work, double done)>;

/// Measures every point of the plan. A stage whose inputs and parameters two points share is computed once. Every stage
/// is timed alone with all threads, so that a point's seconds are the sum of the seconds of its stages. (A run computes
/// independent stages at the same time. It takes about as long where the stages use all cores, and less where they do
/// not.) What is measured is kept in OUT/.trade: a stopped sweep continues, and an unchanged one computes nothing. A
/// point that a quality gate refuses (80) is kept with the reason; any other fault ends the sweep.
///
/// The scene's limits do not bound the points, but are reported (beyond_scene): the sweep is there to show what lies
/// beyond them.
///
/// Throws what read_case_config and the stages throw; 80 where the finest result itself is refused; 64 where the series
/// is not given; 81 as a run would.
TradeResult measure_trade(const TradeRequest& request, const TradeObserver& observer = {});

/// The results as a file with one row for each point and anatomy, and one row for the whole case.
std::string trade_csv(const TradeResult& result);
/// The text of trade.json: everything, with the fronts and the profiles. read_trade_front reads it.
std::string trade_json(const TradeResult& result, const std::string& program_version);
/// The fronts and the profiles as a table for a person.
std::string trade_table(const TradeResult& result);

/// Writes OUT/trade.csv, trade.json and error_{seconds,triangles,bytes}.{png,svg}. gnuplot makes the pictures; where it
/// cannot be run they are left out with a warning. Files that would not change are left as they are.
void write_trade(const TradeResult& result, const std::filesystem::path& out, const std::string& program_version);

}  // namespace trephine::trade
