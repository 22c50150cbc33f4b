// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/graph.h"

#include <algorithm>

#include "base/error.h"
#include "base/hash.h"
#include "boolean/cut_surface.h"
#include "grid/resample.h"
#include "stages/import.h"
#include "stages/points.h"

namespace trephine {
namespace {

// The parameters as text. The hash of a file's content stands for its path.
std::string parameters_text(const Node& node) {
  if (node.file_sha256.empty()) return to_text(node.params);
  std::string text;
  for (const auto& [name, value] : node.recorded()) text += name + ": " + to_text(value) + "; ";
  return text;
}

class Builder {
 public:
  Builder(const CaseConfig& config, const std::string& input_hash, const HashOfScan& hash_of_scan)
      : config_(config), hash_of_scan_(hash_of_scan) {
    ImportStageParams params;
    static_cast<ImportParams&>(params) = config.import;
    params.input = config.series.string();
    Node import = node_of_role(StageRole::import, "import", AnyParams::make(params));
    import.file_sha256["input"] = input_hash;
    add(std::move(import));
  }

  Graph build() {
    if (const RecipeStep* step = config_.find_scan_step(StageRole::suitability)) {
      Node node = node_of_step(*step, step->type->name);
      give_scan(node, 0);
      graph_.quality = add(std::move(node));
    }
    original_ = graph_.scan = prepared(resampled());
    if (config_.face == "crop" || config_.face == "deface") graph_.scan = deface();
    if (config_.ct) graph_.ct = graph_.scan;
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
      if (config_.haptic.encoding() == HapticEncoding::occupancy) first_surface_of(shape.name);
    if (config_.find_scan_step(StageRole::check)) graph_.anatomy_gate = anatomy_gate();
    if (needs_landmarks()) landmarks();
    for (const CaseDrill& hole : config_.burr_holes) graph_.burr_holes.push_back(burr_hole(hole));
    for (const SceneDrill& drilled : config_.drilled)
      for (Graph::Anatomy& anatomy : graph_.anatomies)
        if (anatomy.name == drilled.anatomy) anatomy.surface = cut(anatomy, drilled);
    if (config_.haptic.wanted) {
      graph_.haptic = haptic();
      graph_.mismatch = mismatch();
    }
    if (config_.find_scan_step(StageRole::deface) && config_.face != "keep") graph_.face_gate = face_gate();
    return std::move(graph_);
  }

 private:
  // The scan that a recipe's step reads, laid on the CT's voxels before the face is taken off: what is made of it is
  // checked for the face like all else.
  int scan_named(const std::string& name, const std::string& reader) {
    if (const auto known = graph_.scans.find(name); known != graph_.scans.end()) return known->second;
    const CaseScan* scan = config_.find_scan(name);
    if (!scan)
      throw Error(ExitCode::bad_config, "", reader + ".scan",
                  name + ", the case has no such scan: name it, scans: {" + name + ": {modality: ..., series: ...}}");
    if (scan->series.empty())
      throw Error(ExitCode::usage, "", "scans." + name + ".series",
                  "is not said, and " + reader + " reads it: give --scan " + name + "=PATH");
    ImportStageParams params;
    static_cast<ImportParams&>(params) = scan->import.as<ImportParams>();
    params.input = scan->series.string();
    Node imported = node_of_role(StageRole::import, name + ".import", AnyParams::make(params));
    imported.file_sha256["input"] = with_field("scans." + name, [&] {
      return hash_of_scan_ ? hash_of_scan_(name, {scan->series, params}) : hash_of_series_input(scan->series, params);
    });
    Node node = node_of_role(StageRole::second_scan, name + ".register", scan->registration);
    add_file_hashes(node);
    node.sources = {{"volume", original_}, {"moving", add(std::move(imported))}};
    return graph_.scans[name] = add(std::move(node));
  }

  static void add_file_hashes(Node& node) {
    for (const std::string& p : node.type->file_params())
      if (const auto file = std::get<std::string>(node.params.get(*node.params.set->find(p))); !file.empty())
        node.file_sha256[p] = sha256_of_file(file);
  }

  static Node node_of_role(StageRole role, const std::string& name, AnyParams params) {
    Node node;
    node.name = name;
    node.type = &stage_of(role);
    node.params = std::move(params);
    node.output = node.type->output;
    return node;
  }
  static Node node_of_role(StageRole role, const std::string& name) {
    return node_of_role(role, name, stage_of(role).make_params());
  }

  static Node node_of_step(const RecipeStep& step, const std::string& name) {
    Node node;
    node.name = name;
    node.type = step.type;
    node.params = step.params;
    node.output = step.type->output;
    add_file_hashes(node);
    return node;
  }

  // A stage that also reads the scan gets it without being told.
  static void give_scan(Node& node, int scan) {
    for (const Port& port : node.type->ports)
      if (port.kind == DataKind::volume && !node.sources.count(port.name)) node.sources[port.name] = scan;
  }

  // With `before`, the node of the scan before its face is taken away.
  int node_of(const RecipeAnatomy& anatomy, std::size_t index, bool before = false) {
    const RecipeStep& step = anatomy.steps[index];
    before &= graph_.scan != original_ || defacing_;
    const int ct = before ? original_ : graph_.scan;
    const std::string name = (before ? "original." : "") + anatomy.name + "." + step.type->name;
    if (const int known = graph_.find(name); known >= 0) return known;
    const int scan = step.scan.empty() || step.scan == first_scan ? ct : scan_named(step.scan, name);
    Node node = node_of_step(step, name);
    node.may_be_missing = may_be_missing(anatomy.name);
    if (step.type->find_port(first_scan)) node.sources[first_scan] = ct;
    node.sources[step.type->ports[0].name] = index == 0 ? scan : node_of(anatomy, index - 1, before);
    for (const auto& [port, source] : step.ports) node.sources[port] = node_named(source, before);
    give_scan(node, scan);
    return add(std::move(node));
  }

  bool may_be_missing(const std::string& anatomy) const {
    return std::any_of(config_.scene.begin(), config_.scene.end(),
                       [&](const SceneAnatomy& a) { return a.name == anatomy && a.may_be_missing; });
  }

  int node_named(const std::string& path, bool before = false) {
    const std::size_t dot = path.find('.');
    const RecipeAnatomy& anatomy = *config_.find_anatomy(path.substr(0, dot));
    for (std::size_t i = 0; i < anatomy.steps.size(); ++i)
      if (anatomy.steps[i].type->name == path.substr(dot + 1)) return node_of(anatomy, i, before);
    return -1;  // unreachable: read_case_config checked it
  }

  // Skin and skull before the face was taken away; the landmarks for defacing are found on them.
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

  // Whether the scene computes the source anyway, or a wanted landmark is found by it.
  bool is_made(const std::string& source) const {
    if (graph_.find(source) >= 0) return true;
    const std::string anatomy = source.substr(0, source.find('.'));
    for (const SceneLandmark& l : config_.scene_landmarks)
      if (config_.target_in(l.name) == anatomy) return true;
    for (const CaseDrill& hole : config_.burr_holes)
      if (config_.target_in(hole.params.as<BurrHoleParams>().toward) == anatomy) return true;
    return false;
  }

  // The landmarks that a person placed, as a source node of their own; -1 where none are given.
  int given_landmarks() {
    if (graph_.given_landmarks >= 0 || config_.landmarks.empty()) return graph_.given_landmarks;
    PointsParams points;
    for (const CaseLandmark& l : config_.landmarks)
      points.landmarks.emplace_back(
          l.name, PointParams{{l.position_mm.x, l.position_mm.y, l.position_mm.z}, l.confidence, l.source});
    return graph_.given_landmarks =
               add(node_of_role(StageRole::given_landmarks, "given_landmarks", AnyParams::make(points)));
  }

  int landmarks_node(const std::string& before, bool required_only) {
    const int given = given_landmarks();
    const RecipeStep& step = *config_.find_scan_step(StageRole::landmarks);
    Node node = whole_head(step, before + step.type->name, required_only);
    if (given >= 0) node.sources["given"] = given;
    return add(std::move(node));
  }

  int landmarks() {
    if (graph_.landmarks < 0) graph_.landmarks = landmarks_node("", false);
    return graph_.landmarks;
  }

  int original_landmarks() {
    if (graph_.scan == original_ && !defacing_) return landmarks();
    if (original_landmarks_ < 0) original_landmarks_ = landmarks_node("original.", true);
    return original_landmarks_;
  }

  // What is removed and what is checked must not rest on given landmarks alone.
  void add_found_landmarks(Node& node) {
    if (config_.landmarks.empty()) return;
    const std::string name = "original.found_landmarks";
    const int known = graph_.find(name);
    node.sources["found"] =
        known >= 0 ? known : add(whole_head(*config_.find_scan_step(StageRole::landmarks), name, true));
  }

  bool needs_landmarks() const {
    if (!config_.find_scan_step(StageRole::landmarks)) return false;
    if (!config_.scene_landmarks.empty()) return true;
    const auto given = config_.landmark_positions_mm();
    for (const CaseDrill& hole : config_.burr_holes)
      if (!missing_landmark(hole.params.as<BurrHoleParams>(), given).empty()) return true;
    return false;
  }

  // The scan on the voxels that the case asks for; the original scan where it asks for none.
  int resampled() {
    const RecipeStep* step = config_.find_scan_step(StageRole::resample);
    if (!step) return 0;
    const auto& spacing_mm = step->params.as<ResampleParams>().spacing_mm;
    if (std::all_of(spacing_mm.begin(), spacing_mm.end(), [](double s) { return s == 0; })) return 0;
    Node node = node_of_step(*step, step->type->name);
    give_scan(node, 0);
    return add(std::move(node));
  }

  // The scan after the recipe's stages that prepare it, in the recipe's order.
  int prepared(int scan) {
    for (const RecipeStep& step : config_.scan_steps) {
      if (step.type->role != StageRole::prepare) continue;
      Node node = node_of_step(step, step.type->name);
      give_scan(node, scan);
      const int after = add(std::move(node));
      if (step.type->draws_removal && config_.face == "keep") graph_.removals.push_back({scan, after});
      scan = after;
    }
    return scan;
  }

  int deface() {
    defacing_ = true;
    const RecipeStep& step = *config_.find_scan_step(StageRole::deface);
    Node node = whole_head(step, step.type->name, true);
    node.sources["landmarks"] = original_landmarks();
    add_found_landmarks(node);
    return graph_.deface = add(std::move(node));
  }

  int anatomy_gate() {
    const RecipeStep& step = *config_.find_scan_step(StageRole::check);
    Node node = node_of_step(step, step.type->name);
    // Only anatomies that the scene shows are checked, not those that merely help to find them.
    for (const auto& [port, source] : step.ports)
      if (config_.is_shown(source.substr(0, source.find('.')))) node.sources[port] = node_named(source);
    if (node.sources.size() < 2) return -1;
    give_scan(node, graph_.scan);
    // The figure by which the case is classed is measured against the midline.
    const bool classed = !config_.roles.class_of.empty() && config_.is_shown(config_.roles.class_of);
    if (classed && config_.find_scan_step(StageRole::landmarks)) node.sources["landmarks"] = landmarks();
    return add(std::move(node));
  }

  int face_gate() {
    const RecipeStep& step = *config_.find_scan_step(StageRole::deface);
    Node node = node_of_role(StageRole::face_check, "face", AnyParams::make<FaceBeliefParams>(config_.face_belief));
    for (const auto& [port, source] : step.ports)
      if (node.type->find_port(port)) node.sources[port] = node_named(source, true);
    node.sources["landmarks"] = original_landmarks();
    add_found_landmarks(node);
    for (const Graph::Anatomy& a : graph_.anatomies) node.sources["surface." + a.name] = a.surface;
    if (graph_.haptic >= 0) node.sources["haptic"] = graph_.haptic;
    if (graph_.ct >= 0) node.sources["ct"] = graph_.ct;
    return add(std::move(node));
  }

  int measure_of(const std::string& name, const Graph::Anatomy& anatomy) {
    Node node = node_of_role(StageRole::measure, name + ".measure");
    node.sources = {{"surface", anatomy.finished}, {"reference", anatomy.first_surface}};
    return add(std::move(node));
  }

  int first_surface_of(const RecipeAnatomy& recipe) {
    for (std::size_t i = 0; i < recipe.steps.size(); ++i)
      if (recipe.steps[i].type->output == DataKind::mesh) return node_of(recipe, i);
    return -1;  // unreachable: a recipe ends in a surface
  }
  int first_surface_of(const std::string& name) { return first_surface_of(*config_.find_anatomy(name)); }

  void add_cutters(Node& node) {
    for (const int hole : graph_.burr_holes) node.sources["cutters." + graph_.nodes[hole].name] = hole;
  }

  int burr_hole(const CaseDrill& hole) {
    Node node = node_of_role(StageRole::burr_hole, hole.name, hole.params);
    const int known = graph_.landmarks >= 0 ? graph_.landmarks : given_landmarks();
    if (known >= 0) node.sources["landmarks"] = known;
    node.sources[node.type->ports[0].name] = first_surface_of(config_.roles.burr_holes.bone);
    if (!config_.roles.burr_holes.over.empty()) node.sources["over"] = first_surface_of(config_.roles.burr_holes.over);
    for (const auto& [zone, clear] : hole.params.as<BurrHoleParams>().avoid)
      node.sources["zone." + zone] = first_surface_of(zone);
    return add(std::move(node));
  }

  int cut(const Graph::Anatomy& anatomy, const SceneDrill& drilled) {
    CutSurfaceParams params;
    params.widen_mm = drilled.widen_mm;
    Node node = node_of_role(StageRole::cut, anatomy.name + ".boolean", AnyParams::make(params));
    node.sources["surface"] = anatomy.finished;
    add_cutters(node);
    return add(std::move(node));
  }

  int haptic() {
    const auto& params = config_.haptic.params.as<VoxelizeStageParams>();
    Node node = node_of_role(StageRole::haptic, "haptic.voxelize", config_.haptic.params);
    node.sources["volume"] = graph_.scan;
    const bool of_surfaces = params.encoding == HapticEncoding::occupancy;
    for (const auto& [name, shape] : params.shapes) {
      if (of_surfaces) node.sources["shape." + name] = first_surface_of(name);
      if (!shape.clear_of.empty()) node.sources["clear." + shape.clear_of] = first_surface_of(shape.clear_of);
    }
    if (!params.region_of.empty()) node.sources["region"] = first_surface_of(params.region_of);
    if (!params.drill.empty()) add_cutters(node);
    return add(std::move(node));
  }

  int mismatch() {
    Node node = node_of_role(StageRole::mismatch, "haptic.mismatch");
    node.sources["haptic"] = graph_.haptic;
    for (const Graph::Anatomy& anatomy : graph_.anatomies)
      for (const SceneShape& shape : config_.haptic.shapes)
        if (shape.name == anatomy.name) node.sources["surface." + shape.name] = anatomy.surface;
    return node.sources.size() > 1 ? add(std::move(node)) : -1;
  }

  int add(Node node) {
    Sha256 hash;
    hash.text("stage").text(node.type->name).integer(node.type->version);
    hash.text(parameters_text(node));
    for (const auto& [port, source] : node.sources) hash.text(port).text(graph_.nodes[source].key);
    node.key = hash.hex();
    graph_.nodes.push_back(std::move(node));
    return static_cast<int>(graph_.nodes.size()) - 1;
  }

  const CaseConfig& config_;
  const HashOfScan& hash_of_scan_;
  Graph graph_;
  bool defacing_ = false;
  int original_landmarks_ = -1;
  int original_ = 0;  // the scan before a face is taken away
};

}  // namespace

int Graph::find(const std::string& name) const {
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].name == name) return static_cast<int>(i);
  return -1;
}

void require_allowed(const Graph& graph, bool allow_external) {
  if (allow_external) return;
  for (const Node& node : graph.nodes)
    if (node.type->runs_program) {
      const Parameter* program = node.params.set->find("program");
      throw Error(ExitCode::usage, "", node.name,
                  "runs the program " + (program ? to_text(node.params.get(*program)) : std::string()) +
                      " that the recipe names; where you trust it, say --allow-external");
    }
}

Graph make_graph(const CaseConfig& config, const std::string& input_hash, const HashOfScan& hash_of_scan) {
  return Builder(config, input_hash, hash_of_scan).build();
}

}  // namespace trephine
