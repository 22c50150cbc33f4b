// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "pipeline/graph.h"
#include "pipeline/stage_cache.h"

namespace trephine {

/// Why a case's stages are what they are: only what the scene requires.
struct Explanation {
  struct Stage {
    std::string name;
    enum class State {
      compute,
      cached,
      known
    } state = State::compute;       ///< known: its report is, and none reads its data
    std::optional<double> seconds;  ///< that it took when it was last computed; nothing where the cache does not know
    std::string why;                ///< "surface that is published; read by skin.measure"
  };
  struct Pruned {
    std::string name, why;
  };
  std::vector<Stage> stages;     ///< as in the graph
  std::vector<Pruned> pruned;    ///< of the recipe, in its order
  std::vector<ValueRow> values;  ///< every parameter of the stages above, and where its value is from
  CaseTrade trade;
};

/// Nothing is computed or written. What the cache holds is looked up but not verified: a run may find an entry damaged
/// and compute it again.
Explanation explain(const CaseConfig& config, const Graph& graph, const std::vector<int>& wanted,
                    const StageCache& cache);

/// For a person, and as JSON.
std::string explanation_table(const Explanation& explanation);
std::string explanation_json(const Explanation& explanation);

}  // namespace trephine
