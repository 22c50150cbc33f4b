// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/graph.h"
#include "pipeline/run_order.h"
#include "pipeline/spilled_data.h"
#include "pipeline/stage_cache.h"

namespace trephine::pipeline {

/// Observes a run. Its functions are called from several threads.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  /// What will be computed, with its expected share of the time that all take, in seconds. It is called before anything
  /// is computed, and again where the size of a surface is known: then of what has not ended, by the thread that made
  /// the surface, while no other stage may begin or end. So it must neither wait for one nor throw.
  virtual void planned(const std::vector<std::pair<std::string, double>>& expected_s) { (void)expected_s; }
  /// Begins what follows the nodes: making pictures and page, and publishing.
  virtual void publishing() {}
  /// The run is refused, and the message is kept in that folder, with pictures where there is something to look at.
  virtual void kept(const std::filesystem::path& folder, bool with_pictures) { (void)folder, (void)with_pictures; }
  /// What the whole run will take, in a line, once its scan is known.
  virtual void estimated(const std::string& needs) { (void)needs; }
  virtual void started(const std::string& node) { (void)node; }
  virtual void progressed(const std::string& node, double fraction) { (void)node, (void)fraction; }
  /// `cached`: it was not computed, but came from the cache.
  virtual void finished(const std::string& node, bool cached, double seconds, const stages::StageOutcome& made) {
    (void)node, (void)cached, (void)seconds, (void)made;
  }
};

/// What a node's stage gave, its data only for wanted nodes: that of others is dropped after the last reader.
struct NodeResult : stages::StageOutcome {
  enum class State { not_needed, computed, cached } state = State::not_needed;
  double seconds = 0;
  std::shared_ptr<const SpilledData> spilled;  ///< holds the data where `data` has none; see ExecuteOptions::spill
  bool kept = false;  ///< computed or cached, and in the cache: the next run need not compute it

  /// The data, from memory or read back from disk, which is done anew at each call. Throws as SpilledData does.
  stages::StageData loaded() const;
};
/// "not needed", "computed" or "cached", as run.json names it.
constexpr const char* name_of(NodeResult::State state) {
  constexpr const char* names[] = {"not needed", "computed", "cached"};
  return names[static_cast<int>(state)];
}

/// What a case asks of what some nodes make, by node: throws Error 80 where it is not so, with the field that it names.
using Asked = std::map<int, std::function<void(const NodeResult& made)>>;

struct ExecuteOptions {
  std::filesystem::path keep;  ///< the output of every node is also written here, cached ones too; empty: not written
  const StageCache* cache =
      nullptr;  ///< if storing fails (a full disk), one warning is logged and nothing more is stored
  const std::atomic<bool>* cancel = nullptr;
  /// Seconds that nodes took in an earlier run, by name; others are expected to take their stage's typical_s.
  std::map<std::string, double> seconds_before;
  std::vector<NodeResult>* made = nullptr;  ///< where an error ends the run, what is made comes here
  /// What an earlier run of nodes with the same keys made, by key: it is not made again.
  std::map<std::string, NodeResult> known;
  /// Large volumes and fields that wait for a reader are laid aside in this folder, also in the results; empty: all
  /// stay in memory.
  std::filesystem::path spill;
  Asked asked;                  ///< held against a node as soon as it is made, computed or cached
  bool allow_external = false;  ///< nodes may run programs that the configuration names
};

/// Computes one node: runs its stage on these inputs. Throws what the stage throws, and Error 65 where a series, or a
/// file that a parameter names, is no longer the one for which the graph was made.
stages::StageOutcome compute_node(const Node& node, stages::StageInputs inputs, const Progress& progress);

/// Computes the wanted nodes and what they need that is not in the cache, and any other node of the graph whose result
/// is not in the cache: that of every node is wanted. Who wants a few nodes alone gives a graph of
/// these. Independent nodes run at the same time on up to
/// thread_count() threads. A stage whose refusal (80) is in the cache is not run again: before anything is computed
/// the same error is thrown, and `options.made` is left empty. The results, one for each node, are the same whatever
/// the thread count. Nodes run in the order of RunOrder. Where a node
/// fails, or is not as `options.asked` wants it, what comes after it in that order is not begun, and is stopped where
/// it runs; what comes before it is made, for it might fail too. So the error thrown is that of the first node in
/// order, whatever failed first in time; its field names the node, or what `asked` names. Where a node that may be
/// missing is refused (80), what runs beside it is made to its end, so that a run without it has only the rest to do.
std::vector<NodeResult> execute(const Graph& graph, const std::vector<int>& wanted, const ExecuteOptions& options,
                                RunObserver& observer);

}  // namespace trephine::pipeline
