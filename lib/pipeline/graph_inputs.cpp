// SPDX-License-Identifier: GPL-3.0-or-later
// Where the inputs of a case's nodes come from. What an input needs and the graph has not yet is added on the way.
#include <algorithm>

#include "base/error.h"
#include "meshing/contour.h"
#include "pipeline/graph_builder.h"
#include "pipeline/graph_nodes.h"
#include "stages/points.h"

namespace trephine::pipeline {

using stages::DataKind, stages::From, stages::Port;

namespace {

// What stands before the names of nodes that still see the face.
const std::string before_face_removal = "original.";

// Inputs are looked for in the order of From, those that a recipe names in the order of their names.
std::vector<const Port*> in_order(const std::vector<Port>& ports) {
  std::vector<const Port*> all;
  for (const Port& p : ports) all.push_back(&p);
  std::stable_sort(all.begin(), all.end(), [](const Port* a, const Port* b) {
    return a->from != b->from ? a->from < b->from : a->from == From::recipe && a->name < b->name;
  });
  return all;
}

}  // namespace

void GraphBuilder::connect(Node& node, const GraphPlace& place) {
  for (const Port* port : in_order(node.type->ports)) {
    if (port->asked && !port->asked(node.params)) continue;
    for (const auto& [name, source] : sources_of(*port, node, place))
      if (source >= 0) node.sources[port->is_many() ? port->group() + "." + name : port->name] = source;
  }
}

// Where an input comes from, and the name of each of many; a source that the case has not is -1.
std::vector<std::pair<std::string, int>> GraphBuilder::sources_of(const Port& port, const Node& node,
                                                                  const GraphPlace& place) {
  std::vector<std::pair<std::string, int>> all;
  if (port.from == From::anatomies) {
    for (const std::string& name : port.anatomies(node.params))
      if (!name.empty()) {
        const config::RecipeAnatomy& recipe = *config_.find_anatomy(name);
        const bool as_field = port.field_does && port.field_does(node.params, name);
        all.emplace_back(name, first_surface_of(recipe, as_field));
      }
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

int GraphBuilder::source_of(const Port& port, const Node& node, const GraphPlace& place) {
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
      return anatomy.empty() ? -1 : first_surface_of(*config_.find_anatomy(anatomy));
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
int GraphBuilder::named(const Port& port, const Node& node, const GraphPlace& place) {
  if (!place.step || !place.step->ports.count(port.name)) return -1;
  const std::string& source = place.step->ports.at(port.name);
  if (node.type->sees_face())
    return port.required ? node_named(source, true) : !place.required_only && is_made(source) ? node_named(source) : -1;
  if (node.type->is_check() && !config_.is_shown(anatomy_of(source))) return -1;
  return node_named(source, place.original);
}

// The scan that a recipe's step reads, laid on the CT's voxels before the face is taken off: what is made of it is
// checked for the face like all else.
int GraphBuilder::scan_named(const std::string& name, const std::string& reader) {
  if (const auto known = graph_.scans.find(name); known != graph_.scans.end()) return known->second;
  const config::CaseScan* scan = config_.find_scan(name);
  if (!scan)
    throw Error(ExitCode::bad_config, "", reader + ".scan",
                name + ", the case has no such scan: name it, scans: {" + name + ": {modality: ..., series: ...}}");
  if (scan->series.empty())
    throw Error(ExitCode::usage, "", "scans." + name + ".series",
                "is not set, and " + reader + " reads it: give --scan " + name + "=PATH");
  const dicom::SeriesChoice series{scan->series, scan->import.as<dicom::ImportParams>()};
  const std::string hash = with_field("scans." + name, [&] {
    return hash_of_scan_ ? hash_of_scan_(name, series)
                         : dicom::hash_of_series_input(series.folder_or_file, series.params);
  });
  GraphPlace place;
  place.further_scan = add(import_node(series, hash, name));
  Node node = node_with(scan->registration, name);
  add_file_hashes(node);
  return graph_.scans[name] = add(std::move(node), place);
}

// A step of an anatomy; `original`: on the scan before its face is taken away.
int GraphBuilder::step_node(const config::RecipeAnatomy& anatomy, std::size_t index, bool original) {
  const config::RecipeStep& step = anatomy.steps[index];
  GraphPlace place{&step};
  place.original = original && (graph_.scan != original_ || defacing_);
  const std::string name =
      (place.original ? before_face_removal : std::string()) + anatomy.name + "." + step.type->name;
  if (const int known = graph_.find(name); known >= 0) return known;
  const bool is_ct = step.scan.empty() || step.scan == config::first_scan;
  place.scan = !is_ct ? scan_named(step.scan, name) : place.original ? original_ : graph_.scan;
  Node node = node_of_step(step, name);
  place.before = index == 0 ? place.scan : step_node(anatomy, index - 1, place.original);
  node.may_be_missing = config_.can_do_without(anatomy.name);
  return add(std::move(node), place);
}

int GraphBuilder::node_named(const std::string& path, bool original) {
  const config::RecipeAnatomy& anatomy = *config_.find_anatomy(anatomy_of(path));
  for (std::size_t i = 0; i < anatomy.steps.size(); ++i)
    if (anatomy.name + "." + anatomy.steps[i].type->name == path) return step_node(anatomy, i, original);
  return -1;  // unreachable: read_case_config checked it
}

// `as_field`: the field before it, where the surface is nothing but its contour and the scene draws no surface of it.
int GraphBuilder::first_surface_of(const config::RecipeAnatomy& recipe, bool as_field) {
  for (const Graph::Anatomy& a : graph_.anatomies) as_field = as_field && a.name != recipe.name;
  for (std::size_t i = 0; i < recipe.steps.size(); ++i) {
    const config::RecipeStep& step = recipe.steps[i];
    if (step.type->output != DataKind::mesh) continue;
    if (as_field && i > 0 && step.params.set == &parameters_of<meshing::ContourParams>()) {
      auto params = step.params.as<meshing::ContourParams>();
      params.within_mm = 0;
      if (to_text(AnyParams::make(params)) == to_text(step.type->make_params())) return step_node(recipe, i - 1);
    }
    return step_node(recipe, i);
  }
  return -1;  // unreachable: a recipe ends in a surface
}

// Whether the scene computes the source anyway, or a wanted landmark is found by it.
bool GraphBuilder::is_made(const std::string& source) const {
  if (graph_.find(source) >= 0) return true;
  const std::string anatomy = anatomy_of(source);
  for (const config::SceneLandmark& l : config_.scene_landmarks)
    if (config_.target_in(l.name) == anatomy) return true;
  for (const config::CaseDrill& hole : config_.burr_holes)
    if (config_.target_in(hole.params.as<boolean::BurrHoleParams>().toward) == anatomy) return true;
  return false;
}

// The landmarks that a person placed, as a source node of their own; -1 where none are given.
int GraphBuilder::given_landmarks() {
  if (config_.landmarks.empty()) return -1;
  stages::PointsParams points;
  for (const cases::CaseLandmark& l : config_.landmarks)
    points.landmarks.emplace_back(
        l.name, stages::PointParams{{l.position_mm.x, l.position_mm.y, l.position_mm.z}, l.confidence, l.source});
  Node node = node_with(AnyParams::make(points));
  const int known = graph_.find(node.name);
  return known >= 0 ? known : add(std::move(node));
}

int GraphBuilder::landmarks_node(const std::string& name, bool required_only, bool without_given) {
  if (const int known = graph_.find(name); known >= 0) return known;
  const config::RecipeStep& step = *config_.landmarks_step();
  GraphPlace place{&step};
  place.required_only = required_only;
  place.without_given = without_given;
  return add(node_of_step(step, name), place);
}

int GraphBuilder::landmarks() {
  return want(landmarks_node(config_.landmarks_step()->type->name, false, false),
              "landmarks that the scene, a burr hole or a check needs");
}

int GraphBuilder::original_landmarks() {
  if (graph_.scan == original_ && !defacing_) return landmarks();
  return landmarks_node(before_face_removal + config_.landmarks_step()->type->name, true, false);
}

// What is removed and what is checked must not rest on given landmarks alone.
int GraphBuilder::found_landmarks() {
  if (config_.landmarks.empty()) return -1;
  return landmarks_node(before_face_removal + "found_" + config_.landmarks_step()->type->name, true, true);
}

}  // namespace trephine::pipeline
