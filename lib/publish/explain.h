// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "pipeline/graph.h"
#include "pipeline/stage_cache.h"

namespace trephine::publish {

/// Why each stage of a case is computed or not: only what the scene requires is computed.
struct Explanation {
  struct Stage {
    std::string name;
    enum class State {
      compute,
      cached,
      known
    } state = State::compute;       ///< known: its report is cached, and no stage reads its data
    std::optional<double> seconds;  ///< of its last computation; nothing where the cache does not know
    std::string why;                ///< "surface that is published; read by skin.measure"
  };
  struct Pruned {
    std::string name, why;
  };
  std::vector<Stage> stages;             ///< as in the graph
  std::vector<Pruned> pruned;            ///< stages of the recipe, in its order
  std::vector<config::ValueRow> values;  ///< everything that has a part in the case, and the source of its value
  config::CaseTrade trade;
};

/// Explains a case without computing or writing anything. Entries of the cache are looked up but not verified: a run
/// may find one damaged and compute it again.
Explanation explain(const config::CaseConfig& config, const pipeline::Graph& graph, const std::vector<int>& wanted,
                    const pipeline::StageCache& cache);

/// Formats the explanation for a person, and as JSON.
std::string explanation_table(const Explanation& explanation);
std::string explanation_json(const Explanation& explanation);

}  // namespace trephine::publish
