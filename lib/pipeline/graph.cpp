// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/graph.h"

#include <algorithm>

#include "base/hash.h"
#include "grid/resample.h"
#include "stages/burr_hole.h"
#include "stages/cut.h"
#include "stages/face_gate.h"
#include "stages/haptic.h"

namespace trephine {
namespace {

// Raised when the import's output changes for the same files and parameters.
constexpr int import_version = 3;

void hash_params(Sha256& hash, const Node& node) {
  for (const Parameter& p : node.params.set->parameters) hash.text(p.name).text(to_text(node.recorded(p)));
}

class Builder {
 public:
  Builder(const CaseConfig& config, const std::string& input_hash) : config_(config) {
    Node import;
    import.name = "import";
    import.params = AnyParams::make<ImportParams>(config.import);
    Sha256 hash;
    hash.text("import").integer(import_version).text(input_hash);
    hash_params(hash, import);
    import.key = hash.hex();
    graph_.nodes.push_back(std::move(import));
  }

  Graph build() {
    original_ = graph_.scan = resampled();
    if (config_.face == "crop" || config_.face == "deface") graph_.scan = deface();
    for (const SceneAnatomy& wanted : config_.scene) {
      const RecipeAnatomy& recipe = *config_.find_anatomy(wanted.name);
      Graph::Anatomy anatomy;
      anatomy.name = wanted.name;
      anatomy.surface = anatomy.finished = node_of(recipe, recipe.steps.size() - 1);
      anatomy.first_surface = first_surface_of(recipe);
      anatomy.measure = measure_of(wanted.name, anatomy);
      graph_.anatomies.push_back(anatomy);
    }
    for (const SceneShape& shape : config_.haptic.shapes)
      if (config_.haptic.spec.encoding == HapticEncoding::occupancy) first_surface_of(shape.name);
    if (config_.find_head_step(anatomy_step)) graph_.anatomy_gate = anatomy_gate();
    if (needs_landmarks()) landmarks();
    for (const CaseDrill& hole : config_.burr_holes) graph_.burr_holes.push_back(burr_hole(hole));
    for (const SceneDrill& drilled : config_.drilled)
      for (Graph::Anatomy& anatomy : graph_.anatomies)
        if (anatomy.name == drilled.anatomy) anatomy.surface = cut(anatomy, drilled.widen_mm);
    if (config_.haptic.wanted) {
      graph_.haptic = haptic();
      graph_.mismatch = mismatch();
    }
    if (config_.find_head_step(deface_step) && config_.face != "keep") graph_.face_gate = face_gate();
    return std::move(graph_);
  }

 private:
  static Node node_of_step(const RecipeStep& step, const std::string& name) {
    Node node;
    node.name = name;
    node.type = step.type;
    node.params = step.params;
    node.output = step.type->output;
    for (const std::string& p : step.type->file_params)
      if (const auto file = std::get<std::string>(step.params.get(*step.params.set->find(p))); !file.empty())
        node.file_sha256[p] = sha256_of_file(file);
    return node;
  }

  // A stage that looks at the scan as well gets it without being told.
  static void give_scan(Node& node, int scan) {
    for (const Port& port : node.type->ports)
      if (port.kind == DataKind::volume && !node.sources.count(port.name)) node.sources[port.name] = scan;
  }

  // `before` a face is taken away: of the scan as it came.
  int node_of(const RecipeAnatomy& anatomy, std::size_t index, bool before = false) {
    const RecipeStep& step = anatomy.steps[index];
    before &= graph_.scan != original_ || defacing_;
    const int scan = before ? original_ : graph_.scan;
    const std::string name = (before ? "original." : "") + anatomy.name + "." + step.type->name;
    if (const int known = graph_.find(name); known >= 0) return known;
    Node node = node_of_step(step, name);
    node.sources[step.type->ports[0].name] = index == 0 ? scan : node_of(anatomy, index - 1, before);
    for (const auto& [port, source] : step.ports) node.sources[port] = node_named(source, before);
    give_scan(node, scan);
    return add(std::move(node));
  }

  int node_named(const std::string& path, bool before = false) {
    const std::size_t dot = path.find('.');
    const RecipeAnatomy& anatomy = *config_.find_anatomy(path.substr(0, dot));
    for (std::size_t i = 0; i < anatomy.steps.size(); ++i)
      if (anatomy.steps[i].type->name == path.substr(dot + 1)) return node_of(anatomy, i, before);
    return -1;  // unreachable: read_case_config checked it
  }

  // Skin and skull as they were before the face went: what tells its landmarks.
  Node whole_head(const RecipeStep& step, const std::string& name, bool required_only) {
    Node node = node_of_step(step, name);
    give_scan(node, original_);
    for (const auto& [port, source] : step.ports)
      if (step.type->find_port(port)->required)
        node.sources[port] = node_named(source, true);
      else if (!required_only && is_made(source))
        node.sources[port] = node_named(source);
    return node;
  }

  // What the scene computes anyway, or a landmark that it wants is found by.
  bool is_made(const std::string& source) const {
    if (graph_.find(source) >= 0) return true;
    const auto in_ventricles = [](const std::string& name) { return name.rfind("monro", 0) == 0; };
    for (const SceneLandmark& l : config_.scene_landmarks)
      if (in_ventricles(l.name)) return true;
    for (const CaseDrill& hole : config_.burr_holes)
      if (in_ventricles(hole.params.as<BurrHoleParams>().toward)) return true;
    return false;
  }

  std::string given_landmarks() const {
    std::string text;
    for (const auto& [name, p] : config_.landmark_positions_mm())
      text += name + " " + to_text(ParameterValue(std::vector<double>{p.x, p.y, p.z})) + ";";
    return text;
  }

  int landmarks_node(const std::string& name, bool required_only) {
    const RecipeStep& step = *config_.find_head_step(landmarks_step);
    Node node = whole_head(step, name, required_only);
    graph_.own_types.push_back(std::make_shared<const StageType>(landmarks_stage(config_.landmarks)));
    node.type = graph_.own_types.back().get();
    node.salt = given_landmarks();
    return add(std::move(node));
  }

  int landmarks() {
    if (graph_.landmarks < 0) graph_.landmarks = landmarks_node("landmarks", false);
    return graph_.landmarks;
  }

  int original_landmarks() {
    if (graph_.scan == original_ && !defacing_) return landmarks();
    const int known = graph_.find("original.landmarks");
    return known >= 0 ? known : landmarks_node("original.landmarks", true);
  }

  bool needs_landmarks() const {
    if (!config_.find_head_step(landmarks_step)) return false;
    if (!config_.scene_landmarks.empty()) return true;
    const auto given = config_.landmark_positions_mm();
    for (const CaseDrill& hole : config_.burr_holes)
      if (!missing_landmark(hole.params.as<BurrHoleParams>(), given).empty()) return true;
    return false;
  }

  // The scan on the voxels that the case asks for; as it came where it asks for none.
  int resampled() {
    const RecipeStep* step = config_.find_head_step(resample_step);
    if (!step) return 0;
    const auto& spacing_mm = step->params.as<ResampleParams>().spacing_mm;
    if (std::all_of(spacing_mm.begin(), spacing_mm.end(), [](double s) { return s == 0; })) return 0;
    Node node = node_of_step(*step, resample_step);
    give_scan(node, 0);
    return add(std::move(node));
  }

  int deface() {
    defacing_ = true;
    const RecipeStep& step = *config_.find_head_step(deface_step);
    Node node = whole_head(step, deface_step, true);
    node.sources["landmarks"] = original_landmarks();
    return add(std::move(node));
  }

  int anatomy_gate() {
    const RecipeStep& step = *config_.find_head_step(anatomy_step);
    Node node = node_of_step(step, anatomy_step);
    // Of what the scene shows; what only helps to find that is nobody's concern.
    for (const auto& [port, source] : step.ports)
      if (config_.is_shown(source.substr(0, source.find('.')))) node.sources[port] = node_named(source);
    if (node.sources.size() < 2) return -1;
    give_scan(node, graph_.scan);
    // Class and shift are the ventricles'.
    if (node.sources.count("ventricles") && config_.find_head_step(landmarks_step))
      node.sources["landmarks"] = landmarks();
    return add(std::move(node));
  }

  int face_gate() {
    const RecipeStep& step = *config_.find_head_step(deface_step);
    Node node = own("face", face_gate_stage());
    for (const auto& [port, source] : step.ports)
      if (port == "skin") node.sources["skin"] = node_named(source, true);
    node.sources["landmarks"] = original_landmarks();
    for (const Graph::Anatomy& a : graph_.anatomies) node.sources["surface." + a.name] = a.surface;
    if (graph_.haptic >= 0) node.sources["haptic"] = graph_.haptic;
    return add(std::move(node));
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
    Node node = own(hole.name, burr_hole_stage(hole.name, config_.landmark_positions_mm()));
    node.params = hole.params;
    node.salt = hole.name + ";" + given_landmarks();  // its cutter bears the name
    if (graph_.landmarks >= 0) node.sources["landmarks"] = graph_.landmarks;
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
    node.sources["volume"] = graph_.scan;
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
    hash_params(hash, node);
    hash.text(node.salt);
    for (const auto& [port, source] : node.sources) hash.text(port).text(graph_.nodes[source].key);
    node.key = hash.hex();
    graph_.nodes.push_back(std::move(node));
    return static_cast<int>(graph_.nodes.size()) - 1;
  }

  const CaseConfig& config_;
  Graph graph_;
  bool defacing_ = false;
  int original_ = 0;  // the scan before a face is taken away
};

}  // namespace

ParameterValue Node::recorded(const Parameter& parameter) const {
  const auto file = file_sha256.find(parameter.name);
  return file == file_sha256.end() ? params.get(parameter) : ParameterValue("sha256 " + file->second);
}

int Graph::find(const std::string& name) const {
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].name == name) return static_cast<int>(i);
  return -1;
}

Graph make_graph(const CaseConfig& config, const std::string& input_hash) {
  return Builder(config, input_hash).build();
}

}  // namespace trephine
