// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/graph.h"

#include <algorithm>

#include "base/error.h"
#include "base/hash.h"
#include "boolean/cut_surface.h"
#include "stages/import.h"
#include "stages/points.h"

namespace trephine::pipeline {

using stages::DataKind, stages::From, stages::Port, stages::StagePlace, stages::StageType;

namespace {

// What the ports of a node are connected to, as far as it differs between nodes of one stage.
struct Place {
  const config::RecipeStep* step = nullptr;  // what a recipe says of the stage
  int scan = 0;                              // the scan that it reads
  int before = -1;                           // the step before it in an anatomy
  bool original = false;                     // of the scan before its face is taken away
  bool required_only = false;                // anatomies that it can do without are left out
  bool without_given = false;                // so are the landmarks that a person placed
  int further_scan = -1;                     // the import of a further scan
  const Graph::Anatomy* of = nullptr;        // the anatomy whose surfaces it reads
};

// Inputs are looked for in the order of From, those that a recipe names in the order of their names.
std::vector<const Port*> in_order(const std::vector<Port>& ports) {
  std::vector<const Port*> all;
  for (const Port& p : ports) all.push_back(&p);
  std::stable_sort(all.begin(), all.end(), [](const Port* a, const Port* b) {
    return a->from != b->from ? a->from < b->from : a->from == From::recipe && a->name < b->name;
  });
  return all;
}

// A stage that every recipe has does nothing with its default parameters.
bool is_idle(const config::RecipeStep& step) {
  return step.type->in_every_recipe && to_text(step.params) == to_text(step.type->make_params());
}

bool is_of_anatomy(const StageType& type) { return type.reads(From::first_surface); }

class Builder {
 public:
  Builder(const config::CaseConfig& config, const std::string& input_hash, const HashOfScan& hash_of_scan)
      : config_(config), hash_of_scan_(hash_of_scan) {
    add(import_node("import", {config.series, config.import}, input_hash));
  }

  Graph build() {
    add_checks_of_scan(true);
    for (const From from : {From::import, From::scan})
      for (const config::RecipeStep& step : config_.scan_steps)
        if (step.type->output == DataKind::volume && step.type->reads(from) && !is_idle(step)) prepare(step);
    original_ = graph_.scan;
    if (config_.takes_face_away()) {
      defacing_ = true;
      const config::RecipeStep& step = *config_.face_step();
      graph_.scan = add(node_of_step(step, step.type->name), {&step});
    }
    if (config_.ct) want(graph_.scan, "CT that is published");
    for (const config::SceneAnatomy& wanted : config_.scene) add_anatomy(*config_.find_anatomy(wanted.name));
    for (const config::SceneShape& shape : config_.haptic.shapes)
      if (config_.haptic.encoding() == voxel::HapticEncoding::occupancy) first_surface_of(shape.name);
    add_checks_of_scan(false);
    if (config_.needs_landmarks()) landmarks();
    for (const config::CaseDrill& hole : config_.burr_holes) want(add(node_with(hole.name, hole.params), Place()));
    if (!config_.burr_holes.empty())
      for (const config::SceneDrill& drilled : config_.drilled)
        for (Graph::Anatomy& anatomy : graph_.anatomies)
          if (anatomy.name == drilled.anatomy) cut(anatomy, drilled);
    for (const Graph::Anatomy& a : graph_.anatomies)
      want(a.surface, "the surface of " + a.name + " that the scene shows");
    if (config_.haptic.wanted) {
      Node node = node_with("", config_.haptic.params);
      node.name = node.type->name_in_case();
      want(add(std::move(node), {nullptr, graph_.scan}), "the scene's haptic volume");
    }
    // Whether the face is gone is asked of all that will be published, so last.
    for (const bool of_face : {false, true})
      for (const StageType* type : stages::stages_of(StagePlace::scene))
        if (type->is_check() && !is_of_anatomy(*type) && type->sees_face() == of_face) add_check_of_scene(*type);
    return std::move(graph_);
  }

 private:
  void connect(Node& node, const Place& place) {
    for (const Port* port : in_order(node.type->ports)) {
      if (port->asked && !port->asked(node.params)) continue;
      for (const auto& [name, source] : sources_of(*port, node, place))
        if (source >= 0) node.sources[port->is_many() ? port->group() + "." + name : port->name] = source;
    }
  }

  // Where an input comes from, and the name of each of many; a source that the case has not is -1.
  std::vector<std::pair<std::string, int>> sources_of(const Port& port, const Node& node, const Place& place) {
    std::vector<std::pair<std::string, int>> all;
    if (port.from == From::anatomies) {
      for (const std::string& name : port.anatomies(node.params))
        if (!name.empty()) all.emplace_back(name, first_surface_of(name));
    } else if (port.from == From::surfaces || port.from == From::felt_surfaces) {
      for (const Graph::Anatomy& a : graph_.anatomies)
        if (port.from == From::surfaces || config_.is_felt(a.name)) all.emplace_back(a.name, a.surface);
    } else if (port.from == From::cutters) {
      for (const int hole : graph_.results(DataKind::cutters)) all.emplace_back(graph_.nodes[hole].name, hole);
    } else {
      all.emplace_back("", source_of(port, node, place));
    }
    return all;
  }

  int source_of(const Port& port, const Node& node, const Place& place) {
    if (place.before >= 0 && &port == &node.type->ports[0]) return place.before;
    switch (port.from) {
      case From::scan:
        return place.scan;
      case From::ct:
        return place.original ? original_ : graph_.scan;
      case From::import:
        return 0;
      case From::original_scan:
        return original_;
      case From::further_scan:
        return place.further_scan;
      case From::published_ct:
        return config_.ct ? graph_.scan : -1;
      case From::given_landmarks:
        return place.without_given ? -1 : given_landmarks();
      case From::known_landmarks:
        return graph_.result(DataKind::landmarks) >= 0 ? graph_.result(DataKind::landmarks) : given_landmarks();
      case From::recipe:
        return named(port, node, place);
      case From::landmarks:
        return config_.landmarks_step() && is_shown(port.role) ? landmarks() : -1;
      case From::original_landmarks:
        return original_landmarks();
      case From::found_landmarks:
        return found_landmarks();
      case From::role: {
        const std::string anatomy = config_.in_role(port.role);
        return anatomy.empty() ? -1 : first_surface_of(anatomy);
      }
      case From::first_surface:
        return place.of->first_surface;
      case From::finished_surface:
        return place.of->finished;
      case From::haptic:
        return graph_.result(DataKind::haptic);
      default:  // of many: sources_of
        return -1;
    }
  }

  // What the recipe names for a port. What sees the face reads what was made of the original scan, and of what it can
  // do without only what is made anyway; a check reads what the scene shows, not what merely helps to find it.
  int named(const Port& port, const Node& node, const Place& place) {
    if (!place.step || !place.step->ports.count(port.name)) return -1;
    const std::string& source = place.step->ports.at(port.name);
    if (node.type->sees_face())
      return port.required                             ? node_named(source, true)
             : !place.required_only && is_made(source) ? node_named(source)
                                                       : -1;
    if (node.type->is_check() && !config_.is_shown(anatomy_of(source))) return -1;
    return node_named(source, place.original);
  }

  bool is_shown(const std::string& role) const { return role.empty() || config_.is_shown(config_.in_role(role)); }

  // The scan that a recipe's step reads, laid on the CT's voxels before the face is taken off: what is made of it is
  // checked for the face like all else.
  int scan_named(const std::string& name, const std::string& reader) {
    if (const auto known = graph_.scans.find(name); known != graph_.scans.end()) return known->second;
    const config::CaseScan* scan = config_.find_scan(name);
    if (!scan)
      throw Error(ExitCode::bad_config, "", reader + ".scan",
                  name + ", the case has no such scan: name it, scans: {" + name + ": {modality: ..., series: ...}}");
    if (scan->series.empty())
      throw Error(ExitCode::usage, "", "scans." + name + ".series",
                  "is not said, and " + reader + " reads it: give --scan " + name + "=PATH");
    const dicom::SeriesChoice series{scan->series, scan->import.as<dicom::ImportParams>()};
    const std::string hash = with_field("scans." + name, [&] {
      return hash_of_scan_ ? hash_of_scan_(name, series)
                           : dicom::hash_of_series_input(series.folder_or_file, series.params);
    });
    Place place;
    place.further_scan = add(import_node(name + ".import", series, hash));
    Node node = node_with(name + ".register", scan->registration);
    add_file_hashes(node);
    return graph_.scans[name] = add(std::move(node), place);
  }

  static Node import_node(const std::string& name, const dicom::SeriesChoice& series, const std::string& hash) {
    stages::ImportStageParams params;
    static_cast<dicom::ImportParams&>(params) = series.params;
    params.input = series.folder_or_file.string();
    Node node = node_with(name, AnyParams::make(params));
    node.file_sha256["input"] = hash;
    return node;
  }

  static void add_file_hashes(Node& node) {
    for (const std::string& p : node.type->file_params())
      if (const auto file = std::get<std::string>(node.params.get(*node.params.set->find(p))); !file.empty())
        node.file_sha256[p] = sha256_of_file(file);
  }

  static Node node_of(const StageType& type, const std::string& name, AnyParams params) {
    Node node;
    node.name = name;
    node.type = &type;
    node.params = std::move(params);
    node.output = type.output;
    return node;
  }
  static Node node_with(const std::string& name, const AnyParams& params) {
    return node_of(stages::stage_with(*params.set), name, params);
  }
  static Node node_of_step(const config::RecipeStep& step, const std::string& name) {
    Node node = node_of(*step.type, name, step.params);
    add_file_hashes(node);
    return node;
  }

  // A step of an anatomy; `original`: on the scan before its face is taken away.
  int node_of(const config::RecipeAnatomy& anatomy, std::size_t index, bool original = false) {
    const config::RecipeStep& step = anatomy.steps[index];
    Place place{&step};
    place.original = original && (graph_.scan != original_ || defacing_);
    const std::string name = (place.original ? "original." : "") + anatomy.name + "." + step.type->name;
    if (const int known = graph_.find(name); known >= 0) return known;
    const bool is_ct = step.scan.empty() || step.scan == config::first_scan;
    place.scan = !is_ct ? scan_named(step.scan, name) : place.original ? original_ : graph_.scan;
    Node node = node_of_step(step, name);
    place.before = index == 0 ? place.scan : node_of(anatomy, index - 1, place.original);
    node.may_be_missing = std::any_of(config_.scene.begin(), config_.scene.end(), [&](const config::SceneAnatomy& a) {
      return a.name == anatomy.name && (a.may_be_missing || !a.stand_in.empty());
    });
    return add(std::move(node), place);
  }

  static std::string anatomy_of(const std::string& source) { return source.substr(0, source.find('.')); }

  int node_named(const std::string& path, bool original = false) {
    const config::RecipeAnatomy& anatomy = *config_.find_anatomy(anatomy_of(path));
    for (std::size_t i = 0; i < anatomy.steps.size(); ++i)
      if (anatomy.name + "." + anatomy.steps[i].type->name == path) return node_of(anatomy, i, original);
    return -1;  // unreachable: read_case_config checked it
  }

  int first_surface_of(const config::RecipeAnatomy& recipe) {
    for (std::size_t i = 0; i < recipe.steps.size(); ++i)
      if (recipe.steps[i].type->output == DataKind::mesh) return node_of(recipe, i);
    return -1;  // unreachable: a recipe ends in a surface
  }
  int first_surface_of(const std::string& name) { return first_surface_of(*config_.find_anatomy(name)); }

  void add_anatomy(const config::RecipeAnatomy& recipe) {
    Graph::Anatomy anatomy;
    anatomy.name = recipe.name;
    anatomy.surface = anatomy.finished = node_of(recipe, recipe.steps.size() - 1);
    anatomy.first_surface = first_surface_of(recipe);
    Place place;
    place.of = &anatomy;
    for (const StageType* type : stages::stages_of(StagePlace::scene))
      if (type->is_check() && is_of_anatomy(*type))
        want(add(node_of(*type, recipe.name + "." + type->name_in_case(), type->make_params()), place),
             type->serves + " " + recipe.name);
    graph_.anatomies.push_back(anatomy);
  }

  void cut(Graph::Anatomy& anatomy, const config::SceneDrill& drilled) {
    boolean::CutSurfaceParams params;
    params.widen_mm = drilled.widen_mm;
    Place place;
    place.of = &anatomy;
    anatomy.surface = add(node_with(anatomy.name + ".boolean", AnyParams::make(params)), place);
  }

  void prepare(const config::RecipeStep& step) {
    const int before = graph_.scan;
    graph_.scan = add(node_of_step(step, step.type->name), {&step, before});
    if (step.type->draws_removal && config_.face == "keep") graph_.removals.push_back({before, graph_.scan});
  }

  // The checks that a recipe names: of the scan as it was read, or of what was made of it.
  void add_checks_of_scan(bool as_read) {
    for (const config::RecipeStep& step : config_.scan_steps) {
      if (!step.type->is_check() || step.type->reads(From::import) != as_read) continue;
      const auto is_shown = [&](const auto& p) { return config_.is_shown(anatomy_of(p.second)); };
      const bool complete = std::all_of(step.ports.begin(), step.ports.end(), [&](const auto& p) {
        return !step.type->find_port(p.first)->required || is_shown(p);
      });
      if (complete && std::count_if(step.ports.begin(), step.ports.end(), is_shown) >= step.type->min_inputs)
        want(add(node_of_step(step, step.type->name), {&step, graph_.scan}), step.type->serves);
    }
  }

  // The checks that no recipe names are made where the case has what they need.
  void add_check_of_scene(const StageType& type) {
    const config::RecipeStep* face = config_.face_step();
    if (type.sees_face() && (!face || config_.face == "keep")) return;
    const AnyParams of_face = AnyParams::make(config_.face_belief), defaults = type.make_params();
    Node node = node_of(type, type.name_in_case(), defaults.set == of_face.set ? of_face : defaults);
    connect(node, {type.sees_face() ? face : nullptr, graph_.scan});
    for (const Port& port : type.ports)
      if (port.required && std::none_of(node.sources.begin(), node.sources.end(), [&](const auto& s) {
            return s.first == port.name || (port.is_many() && s.first.rfind(port.group() + ".", 0) == 0);
          }))
        return;
    want(add(std::move(node)), type.serves);
  }

  // Whether the scene computes the source anyway, or a wanted landmark is found by it.
  bool is_made(const std::string& source) const {
    if (graph_.find(source) >= 0) return true;
    const std::string anatomy = anatomy_of(source);
    for (const config::SceneLandmark& l : config_.scene_landmarks)
      if (config_.target_in(l.name) == anatomy) return true;
    for (const config::CaseDrill& hole : config_.burr_holes)
      if (config_.target_in(hole.params.as<boolean::BurrHoleParams>().toward) == anatomy) return true;
    return false;
  }

  // The landmarks that a person placed, as a source node of their own; -1 where none are given.
  int given_landmarks() {
    if (config_.landmarks.empty()) return -1;
    stages::PointsParams points;
    for (const cases::CaseLandmark& l : config_.landmarks)
      points.landmarks.emplace_back(
          l.name, stages::PointParams{{l.position_mm.x, l.position_mm.y, l.position_mm.z}, l.confidence, l.source});
    Node node = node_with("", AnyParams::make(points));
    node.name = node.type->name_in_case();
    const int known = graph_.find(node.name);
    return known >= 0 ? known : add(std::move(node));
  }

  int landmarks_node(const std::string& name, bool required_only, bool without_given) {
    if (const int known = graph_.find(name); known >= 0) return known;
    const config::RecipeStep& step = *config_.landmarks_step();
    Place place{&step};
    place.required_only = required_only;
    place.without_given = without_given;
    return add(node_of_step(step, name), place);
  }

  int landmarks() {
    return want(landmarks_node(config_.landmarks_step()->type->name, false, false),
                "landmarks that the scene, a burr hole or a check needs");
  }

  int original_landmarks() {
    if (graph_.scan == original_ && !defacing_) return landmarks();
    return landmarks_node("original." + config_.landmarks_step()->type->name, true, false);
  }

  // What is removed and what is checked must not rest on given landmarks alone.
  int found_landmarks() {
    return config_.landmarks.empty() ? -1 : landmarks_node("original.found_landmarks", true, true);
  }

  int want(int node, const std::string& for_what = "") {
    graph_.nodes[node].wanted = true;
    graph_.nodes[node].serves = for_what;
    return node;
  }

  int add(Node node, const Place& place) {
    connect(node, place);
    return add(std::move(node));
  }

  int add(Node node) {
    Sha256 hash;
    hash.text("stage").text(node.type->name).integer(node.type->version);
    hash.text(node.parameters_text());
    for (const auto& [port, source] : node.sources) hash.text(port).text(graph_.nodes[source].key);
    node.key = hash.hex();
    graph_.nodes.push_back(std::move(node));
    return static_cast<int>(graph_.nodes.size()) - 1;
  }

  const config::CaseConfig& config_;
  const HashOfScan& hash_of_scan_;
  Graph graph_;
  bool defacing_ = false;
  int original_ = 0;  // the scan before a face is taken away
};

}  // namespace

Graph make_graph(const config::CaseConfig& config, const std::string& input_hash, const HashOfScan& hash_of_scan) {
  return Builder(config, input_hash, hash_of_scan).build();
}

}  // namespace trephine::pipeline
