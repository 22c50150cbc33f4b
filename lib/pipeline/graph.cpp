// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/graph.h"

#include "base/hash.h"
#include "stages/burr_hole.h"
#include "stages/cut.h"
#include "stages/haptic.h"

namespace trephine {
namespace {

// Raised when the import's output changes for the same files and parameters.
constexpr int import_version = 3;

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
      anatomy.surface = anatomy.finished = node_of(recipe, recipe.steps.size() - 1);
      anatomy.first_surface = first_surface_of(recipe);
      anatomy.measure = measure_of(wanted.name, anatomy);
      graph_.anatomies.push_back(anatomy);
    }
    for (const CaseDrill& hole : config_.burr_holes) graph_.burr_holes.push_back(burr_hole(hole));
    for (const SceneDrill& drilled : config_.drilled)
      for (Graph::Anatomy& anatomy : graph_.anatomies)
        if (anatomy.name == drilled.anatomy) anatomy.surface = cut(anatomy, drilled.widen_mm);
    if (config_.haptic.wanted) {
      graph_.haptic = haptic();
      graph_.mismatch = mismatch();
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
    node.sources = {{"surface", anatomy.finished}, {"reference", anatomy.first_surface}};
    return add(std::move(node));
  }

  int first_surface_of(const RecipeAnatomy& recipe) {
    for (std::size_t i = 0; i < recipe.steps.size(); ++i)
      if (recipe.steps[i].type->output == DataKind::mesh) return node_of(recipe, i);
    return -1;  // unreachable: a recipe ends in a surface
  }
  int first_surface_of(const std::string& name) { return first_surface_of(*config_.find_anatomy(name)); }

  // A node of a stage that is made for this case.
  Node own(const std::string& name, StageType type) {
    graph_.own_types.push_back(std::make_shared<const StageType>(std::move(type)));
    Node node;
    node.name = name;
    node.type = graph_.own_types.back().get();
    node.params = node.type->make_params();
    node.output = node.type->output;
    return node;
  }

  void add_cutters(Node& node) {
    for (const int hole : graph_.burr_holes) node.sources["cutters." + graph_.nodes[hole].name] = hole;
  }

  int burr_hole(const CaseDrill& hole) {
    const auto landmarks = config_.landmark_positions_mm();
    Node node = own(hole.name, burr_hole_stage(hole.name, landmarks));
    node.params = hole.params;
    node.salt = hole.name + ";";  // its cutter bears it
    for (const auto& [name, p] : landmarks)
      node.salt += name + " " + to_text(ParameterValue(std::vector<double>{p.x, p.y, p.z})) + ";";
    node.sources["skull"] = first_surface_of("skull");
    if (config_.find_anatomy("skin")) node.sources["skin"] = first_surface_of("skin");
    return add(std::move(node));
  }

  int cut(const Graph::Anatomy& anatomy, double widen_mm) {
    Node node = own(anatomy.name + ".boolean", boolean_stage(widen_mm));
    node.salt = to_text(ParameterValue(widen_mm));
    node.sources["surface"] = anatomy.finished;
    add_cutters(node);
    return add(std::move(node));
  }

  int haptic() {
    const SceneHaptic& wanted = config_.haptic;
    Node node = own("haptic.voxelize", voxelize_stage(wanted.spec));
    node.params = wanted.params;
    node.salt = to_text(wanted.spec);
    node.sources["volume"] = 0;
    const bool of_surfaces = wanted.spec.encoding == HapticEncoding::occupancy;
    for (const HapticShapeSpec& shape : wanted.spec.shapes) {
      if (of_surfaces) node.sources["shape." + shape.name] = first_surface_of(shape.name);
      if (!shape.clear_of.empty()) node.sources["clear." + shape.clear_of] = first_surface_of(shape.clear_of);
    }
    if (!wanted.spec.region_of.empty()) node.sources["region"] = first_surface_of(wanted.spec.region_of);
    for (const HapticShapeSpec& shape : wanted.spec.shapes)
      if (shape.drilled) {
        add_cutters(node);
        break;
      }
    return add(std::move(node));
  }

  int mismatch() {
    Node node = own("haptic.mismatch", mismatch_stage());
    node.sources["haptic"] = graph_.haptic;
    for (const Graph::Anatomy& anatomy : graph_.anatomies)
      for (const SceneShape& shape : config_.haptic.shapes)
        if (shape.name == anatomy.name) node.sources["surface." + shape.name] = anatomy.surface;
    return node.sources.size() > 1 ? add(std::move(node)) : -1;
  }

  int add(Node node) {
    Sha256 hash;
    hash.text("stage").text(node.type->name).integer(node.type->version);
    hash_params(hash, node.params);
    hash.text(node.salt);
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
