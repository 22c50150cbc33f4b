// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/graph.h"

#include "base/hash.h"

namespace trephine {
namespace {

// Raised when the import's output changes for the same files and parameters.
constexpr int import_version = 2;

void hash_params(Sha256& hash, const AnyParams& params) {
  for (const Parameter& p : params.set->parameters) hash.text(p.name).text(to_text(params.get(p)));
}

class Builder {
 public:
  Builder(const CaseConfig& config, const std::string& input_hash) : config_(config) {
    Node import;
    import.name = "import";
    import.params = AnyParams::make<ImportParams>(config.import);
    Sha256 hash;
    hash.text("import").integer(import_version).text(input_hash);
    hash_params(hash, import.params);
    import.key = hash.hex();
    graph_.nodes.push_back(std::move(import));
  }

  Graph build() {
    for (const SceneAnatomy& wanted : config_.scene) {
      const RecipeAnatomy& recipe = *config_.find_anatomy(wanted.name);
      Graph::Anatomy anatomy;
      anatomy.name = wanted.name;
      anatomy.surface = node_of(recipe, recipe.steps.size() - 1);
      for (std::size_t i = recipe.steps.size(); i-- > 0;)
        if (recipe.steps[i].type->output == DataKind::mesh) anatomy.first_surface = node_of(recipe, i);
      anatomy.measure = measure_of(wanted.name, anatomy);
      graph_.anatomies.push_back(anatomy);
    }
    return std::move(graph_);
  }

 private:
  int node_of(const RecipeAnatomy& anatomy, std::size_t index) {
    const RecipeStep& step = anatomy.steps[index];
    const std::string name = anatomy.name + "." + step.type->name;
    if (const int known = graph_.find(name); known >= 0) return known;
    Node node;
    node.name = name;
    node.type = step.type;
    node.params = step.params;
    node.output = step.type->output;
    node.sources[step.type->ports[0].name] = index == 0 ? 0 : node_of(anatomy, index - 1);
    for (const auto& [port, source] : step.ports) node.sources[port] = node_named(source);
    // A stage that looks at the scan as well gets it without being told.
    for (const Port& port : step.type->ports)
      if (port.kind == DataKind::volume && !node.sources.count(port.name)) node.sources[port.name] = 0;
    return add(std::move(node));
  }

  int node_named(const std::string& path) {
    const std::size_t dot = path.find('.');
    const RecipeAnatomy& anatomy = *config_.find_anatomy(path.substr(0, dot));
    for (std::size_t i = 0; i < anatomy.steps.size(); ++i)
      if (anatomy.steps[i].type->name == path.substr(dot + 1)) return node_of(anatomy, i);
    return -1;  // unreachable: read_case_config checked it
  }

  int measure_of(const std::string& name, const Graph::Anatomy& anatomy) {
    Node node;
    node.name = name + ".measure";
    node.type = find_stage("measure");
    node.params = node.type->make_params();
    node.output = DataKind::nothing;
    node.sources = {{"surface", anatomy.surface}, {"reference", anatomy.first_surface}};
    return add(std::move(node));
  }

  int add(Node node) {
    Sha256 hash;
    hash.text("stage").text(node.type->name).integer(node.type->version);
    hash_params(hash, node.params);
    for (const auto& [port, source] : node.sources) hash.text(port).text(graph_.nodes[source].key);
    node.key = hash.hex();
    graph_.nodes.push_back(std::move(node));
    return static_cast<int>(graph_.nodes.size()) - 1;
  }

  const CaseConfig& config_;
  Graph graph_;
};  // namespace

}  // namespace

int Graph::find(const std::string& name) const {
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].name == name) return static_cast<int>(i);
  return -1;
}

Graph make_graph(const CaseConfig& config, const std::string& input_hash) {
  return Builder(config, input_hash).build();
}

}  // namespace trephine
