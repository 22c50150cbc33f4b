// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/graph.h"
#include "pipeline/stage_cache.h"

namespace trephine {

/// Who watches a run. Called from several threads.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  virtual void started(const std::string& node) = 0;
  virtual void progressed(const std::string& node, double fraction) = 0;
  /// `how`: computed or cached.
  virtual void finished(const std::string& node, const std::string& how, double seconds, const Report& report) = 0;
};

struct NodeResult {
  enum class State { not_needed, computed, cached } state = State::not_needed;
  StageData data;  ///< only of the nodes asked for; others are let go after their last reader
  Report report;
  double seconds = 0;
};

struct ExecuteOptions {
  std::filesystem::path keep;  ///< every node's output is written here too, the cached ones as well; empty: not
  const StageCache* cache =
      nullptr;  ///< where storing fails (a full disk), a warning is logged, once, and no more stored
  const std::atomic<bool>* cancel = nullptr;
};

/// One node's work: its stage on these inputs. Throws what the stage does; 65 where a series is no longer what the
/// graph was made for.
StageData compute_node(const Node& node, StageInputs inputs, Report& report, const Progress& progress);

/// Computes the nodes asked for and what they need that the cache does not have; independent nodes run at the same time
/// on up to thread_count() threads. The results, one a node, are the same whatever the thread count. The error of the
/// first node (in the graph's order) that failed is thrown, its field naming the node, after the others were stopped.
std::vector<NodeResult> execute(const Graph& graph, const std::vector<int>& wanted, const ExecuteOptions& options,
                                RunObserver& observer);

}  // namespace trephine
