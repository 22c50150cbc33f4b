// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "pipeline/executor.h"
#include "pipeline/stage_cache.h"

namespace trephine::trade {

/// What one piece of work gave, and what each of its repeats took.
struct Measurement {
  std::string values;           ///< JSON: of a stage its outcome (stages/data_files.h), else a declared struct
  std::vector<double> seconds;  ///< of each repeat, in their order; empty where it was refused
  double peak_memory_mb = 0;    ///< of the process while it ran with its inputs and nothing else; 0: not known
  std::string refused;          ///< the reason of the quality gate (80) that it did not pass; empty: it passed
  double median_s() const;
  double spread_s() const;  ///< largest less smallest
};

/// Measurements on disk, by key, so that a sweep continues where it was stopped and computes nothing twice. A record
/// that cannot be read counts as missing.
class MeasurementStore {
 public:
  /// Throws Error 73 where the folder cannot be made.
  explicit MeasurementStore(std::filesystem::path folder);
  /// The measurement, or null where there is none.
  const Measurement* find(const std::string& key);
  const Measurement& keep(const std::string& key, Measurement measurement);
  /// Removes the records whose keys were not used since this object was made. Returns how many.
  int remove_unused();

 private:
  std::filesystem::path folder_;
  std::map<std::string, Measurement> known_;
  std::set<std::string> absent_;
};

/// How often a piece of work is timed: up to `count` times, but not again once all its repeats together took max_s.
struct Repeats {
  int count = 3;
  double max_s = 15;
  bool suffice(const Measurement& m) const;
};

/// Does the work that often, with nothing else running, and measures it; its values are those of the first time. An
/// Error 80 is kept as `refused`, worded as of that stage; any other is thrown.
Measurement measure_work(const Repeats& repeats, const std::function<std::string()>& work,
                         const std::string& stage = "");

/// The stages of a sweep. Each is computed once for all the points that share it, timed alone, repeated, and kept with
/// its output in a stage cache.
class TimedStages {
 public:
  struct Options {
    Repeats repeats;
    const pipeline::StageCache* cache = nullptr;
    const std::atomic<bool>* cancel = nullptr;
    std::function<void(const std::string& node, double fraction)> progress;
  };
  TimedStages(MeasurementStore& store, Options options) : store_(store), options_(std::move(options)) {}

  /// Measures what is not measured yet. Returns the first stage that a quality gate refused, or nothing.
  struct Refusal {
    std::string node, why;
  };
  std::optional<Refusal> measure(const pipeline::Graph& graph);
  /// The node's output: from memory, from the cache, or computed again.
  stages::StageData data(const pipeline::Graph& graph, int node);
  /// Drops everything that is held in memory.
  void forget() { held_.clear(); }
  /// How many stages had to be computed since the last call.
  int take_measured_count() { return std::exchange(measured_, 0); }

 private:
  stages::StageInputs inputs(const pipeline::Graph& graph, int node);
  Progress progress_of(const std::string& node) const;

  MeasurementStore& store_;
  Options options_;
  std::map<std::string, stages::StageData> held_;  // by key
  int measured_ = 0;
};

}  // namespace trephine::trade
