// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/graph.h"
#include "stages/stage.h"

namespace trephine::pipeline {

/// How long the nodes of a graph are expected to take: what they took in an earlier run, else what their stage
/// typically takes on a head, and on a surface of so many triangles as soon as that is known.
class ExpectedTime {
 public:
  /// The graph and the seconds must outlive it.
  ExpectedTime(const Graph& graph, const std::map<std::string, double>& seconds_before);
  /// The node's output; whether that says more of how long the rest takes.
  bool learn(int node, const stages::StageData& output);
  /// Of the nodes that are to be done, each one's share of the wall clock's seconds on thread_count() threads.
  std::vector<std::pair<std::string, double>> plan(const std::vector<char>& to_do) const;

 private:
  double seconds_of(const Node& node) const;
  const Graph& graph_;
  const std::map<std::string, double>& before_;
  std::vector<double> triangles_;  ///< of a node's output, once it is made
};

}  // namespace trephine::pipeline
