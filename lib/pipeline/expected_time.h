// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/graph.h"
#include "stages/stage.h"

namespace trephine::pipeline {

/// How long the nodes of a graph are expected to take: what they took in the last run that used the same cache, be it
/// of another patient of the library; else what their stages typically take on so many voxels and triangles, of which
/// more is known as the run goes on. Both follow what the nodes that have run took beside what was expected of them:
/// a machine may be slow, and a stage may find a scan hard. It may fail to foresee a scan whose anatomies are unlike
/// those of the scans that were measured.
class ExpectedTime {
 public:
  /// The graph and the seconds must outlive it.
  ExpectedTime(const Graph& graph, const std::map<std::string, double>& seconds_before);
  /// What the node hands on; `took_s` is 0 where it did not run now.
  void learn(int node, const stages::StageData& output, double took_s = 0);
  /// Of the nodes that are to be done, each one's share of the wall clock's seconds on thread_count() threads.
  std::vector<std::pair<std::string, double>> plan(const std::vector<char>& to_do) const;

 private:
  // What is in a node's output: counted, or as long as it is not made, expected.
  struct Amount {
    bool counted = false;
    double million_voxels = 0;
    double plane_ratio = 0;  // pixels of a slice, of 512 x 512
    double million_triangles = 0;
  };
  struct Taken {
    double expected_s = 0, took_s = 0;
    double ratio(double held_s, double prior) const { return (took_s + held_s * prior) / (expected_s + held_s); }
  };
  Amount read_by(const Node& node) const;
  void expect_amounts();
  double typical_s(const Node& node) const;
  double seconds_of(const Node& node) const;
  const Graph& graph_;
  const std::map<std::string, double>& before_;
  std::vector<Amount> amounts_;                   // of the nodes' outputs
  Taken by_earlier_, by_typical_;                 // of the nodes that have run
  std::map<const stages::StageType*, Taken> of_;  // by_typical_, of each stage
};

}  // namespace trephine::pipeline
