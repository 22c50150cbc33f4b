// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of pipeline: how the graph of a case is made. graph.cpp says which nodes it has, graph_inputs.cpp where their
// inputs come from, and graph_nodes.cpp what a node is made of.
#include <string>
#include <utility>
#include <vector>

#include "pipeline/graph.h"

namespace trephine::pipeline {

/// What the ports of a node are connected to, as far as it differs between nodes of one stage.
struct GraphPlace {
  const config::RecipeStep* step = nullptr;  ///< what a recipe says of the stage
  int scan = 0;                              ///< the scan that it reads
  int before = -1;                           ///< the step before it in an anatomy
  bool original = false;                     ///< of the scan before its face is taken away
  bool required_only = false;                ///< anatomies that it can do without are left out
  bool without_given = false;                ///< so are the landmarks that a person placed
  int further_scan = -1;                     ///< the import of a further scan
  const Graph::Anatomy* of = nullptr;        ///< the anatomy whose surfaces it reads
};

/// Nodes are numbers of graph_.nodes; -1: the case has no such node.
class GraphBuilder {
 public:
  GraphBuilder(const config::CaseConfig& config, const std::string& input_hash, const HashOfScan& hash_of_scan);
  Graph build();

 private:
  void add_anatomy(const config::RecipeAnatomy& recipe);
  void cut(Graph::Anatomy& anatomy, const config::SceneDrill& drilled);
  void prepare(const config::RecipeStep& step);
  void add_checks_of_scan(bool as_read);
  void add_check_of_scene(const stages::StageType& type);
  void add_early_check(int check);
  /// The case reads the node's data or report itself.
  int want(int node, const std::string& for_what = "");
  /// Adds the node; the first one connects its ports before.
  int add(Node node, const GraphPlace& place);
  int add(Node node);

  // graph_inputs.cpp
  void connect(Node& node, const GraphPlace& place);
  std::vector<std::pair<std::string, int>> sources_of(const stages::Port& port, const Node& node,
                                                      const GraphPlace& place);
  int source_of(const stages::Port& port, const Node& node, const GraphPlace& place);
  int named(const stages::Port& port, const Node& node, const GraphPlace& place);
  bool is_shown(const std::string& role) const { return role.empty() || config_.is_shown(config_.in_role(role)); }
  int scan_named(const std::string& name, const std::string& reader);
  int step_node(const config::RecipeAnatomy& anatomy, std::size_t index, bool original = false);
  int node_named(const std::string& path, bool original = false);
  int first_surface_of(const config::RecipeAnatomy& recipe, bool as_field = false);
  bool is_made(const std::string& source) const;
  int given_landmarks();
  int landmarks_node(const std::string& name, bool required_only, bool without_given);
  int landmarks();
  int original_landmarks();
  int found_landmarks();

  const config::CaseConfig& config_;
  const HashOfScan& hash_of_scan_;
  Graph graph_;
  bool defacing_ = false;
  int original_ = 0;  ///< the scan before a face is taken away
};

}  // namespace trephine::pipeline
