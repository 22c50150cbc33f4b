// SPDX-License-Identifier: GPL-3.0-or-later
// Which nodes a case has.
#include "pipeline/graph.h"

#include <algorithm>
#include <utility>

#include "base/hash.h"
#include "boolean/cut_surface.h"
#include "pipeline/graph_builder.h"
#include "pipeline/graph_nodes.h"

namespace trephine::pipeline {

using stages::DataKind, stages::From, stages::Port, stages::StagePlace, stages::StageType;

namespace {

// A stage that every recipe has does nothing with its default parameters.
bool is_idle(const config::RecipeStep& step) {
  return step.type->in_every_recipe && to_text(step.params) == to_text(step.type->make_params());
}

bool is_of_anatomy(const StageType& type) { return type.reads(From::first_surface); }

}  // namespace

GraphBuilder::GraphBuilder(const config::CaseConfig& config, const std::string& input_hash,
                           const HashOfScan& hash_of_scan)
    : config_(config), hash_of_scan_(hash_of_scan) {
  add(import_node({config.series, config.import}, input_hash));
}

Graph GraphBuilder::build() {
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
    if (config_.haptic.encoding() == voxel::HapticEncoding::occupancy)
      first_surface_of(*config_.find_anatomy(shape.name), true);
  add_checks_of_scan(false);
  if (config_.needs_landmarks()) landmarks();
  for (const config::CaseDrill& hole : config_.burr_holes) {
    Node node = node_with(hole.params);
    node.name = hole.name;
    want(add(std::move(node), GraphPlace()));
  }
  if (!config_.burr_holes.empty())
    for (const config::SceneDrill& drilled : config_.drilled)
      for (Graph::Anatomy& anatomy : graph_.anatomies)
        if (anatomy.name == drilled.anatomy) cut(anatomy, drilled);
  for (const Graph::Anatomy& a : graph_.anatomies)
    want(a.surface, "the surface of " + a.name + " that the scene shows");
  if (config_.haptic.wanted)
    want(add(node_with(config_.haptic.params), {nullptr, graph_.scan}), "the scene's haptic volume");
  // Whether the face is gone is asked of all that will be published, so last.
  for (const bool of_face : {false, true})
    for (const StageType* type : stages::stages_of(StagePlace::scene))
      if (type->is_check() && !is_of_anatomy(*type) && type->sees_face() == of_face) add_check_of_scene(*type);
  return std::move(graph_);
}

void GraphBuilder::add_anatomy(const config::RecipeAnatomy& recipe) {
  Graph::Anatomy anatomy;
  anatomy.name = recipe.name;
  anatomy.surface = anatomy.finished = step_node(recipe, recipe.steps.size() - 1);
  anatomy.first_surface = first_surface_of(recipe);
  GraphPlace place;
  place.of = &anatomy;
  for (const StageType* type : stages::stages_of(StagePlace::scene))
    if (type->is_check() && is_of_anatomy(*type))
      want(add(node_of(*type, recipe.name + "." + type->name_in_case(), type->make_params()), place),
           type->check.serves + " " + recipe.name);
  graph_.anatomies.push_back(anatomy);
}

void GraphBuilder::cut(Graph::Anatomy& anatomy, const config::SceneDrill& drilled) {
  boolean::CutSurfaceParams params;
  params.widen_mm = drilled.widen_mm;
  GraphPlace place;
  place.of = &anatomy;
  anatomy.surface = add(node_with(AnyParams::make(params), anatomy.name), place);
}

void GraphBuilder::prepare(const config::RecipeStep& step) {
  const int before = graph_.scan;
  graph_.scan = add(node_of_step(step, step.type->name), {&step, before});
  if (step.type->effect == stages::StageEffect::draws_removal && config_.face == "keep")
    graph_.removals.push_back({before, graph_.scan});
}

// The checks that a recipe names: of the scan as it was read, or of what was made of it.
void GraphBuilder::add_checks_of_scan(bool as_read) {
  for (const config::RecipeStep& step : config_.scan_steps) {
    if (!step.type->is_check() || step.type->reads(From::import) != as_read || is_idle(step)) continue;
    const auto is_shown = [&](const auto& p) { return config_.is_shown(anatomy_of(p.second)); };
    const bool complete = std::all_of(step.ports.begin(), step.ports.end(), [&](const auto& p) {
      return !step.type->find_port(p.first)->required || is_shown(p);
    });
    if (complete && std::count_if(step.ports.begin(), step.ports.end(), is_shown) >= step.type->check.min_inputs)
      add_early_check(want(add(node_of_step(step, step.type->name), {&step, graph_.scan}), step.type->check.serves));
  }
}

// The same check of the inputs by which alone it may refuse, and of the scan, for a picture of what is wrong.
void GraphBuilder::add_early_check(int check) {
  const Node& whole = graph_.nodes[check];
  const auto& by = whole.type->check.refuses_early_by;
  Node early = node_of(*whole.type, whole.name, whole.params);
  early.file_sha256 = whole.file_sha256;
  early.is_early = true;
  std::size_t found = 0;
  for (const auto& [port, source] : whole.sources) {
    const bool is_first = std::find(by.begin(), by.end(), port) != by.end();
    if (is_first || whole.type->find_port(port)->kind == DataKind::volume) early.sources[port] = source;
    found += is_first;
  }
  if (by.empty() || found < by.size() || early.sources.size() == whole.sources.size()) return;
  for (const std::string& port : by) early.name += (&port == &by.front() ? "." : "_") + port;
  want(add(std::move(early)), whole.type->check.serves);
}

// The checks that no recipe names are made where the case has what they need.
void GraphBuilder::add_check_of_scene(const StageType& type) {
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
  want(add(std::move(node)), type.check.serves);
}

int GraphBuilder::want(int node, const std::string& for_what) {
  graph_.nodes[node].wanted = true;
  graph_.nodes[node].serves = for_what;
  return node;
}

int GraphBuilder::add(Node node, const GraphPlace& place) {
  connect(node, place);
  return add(std::move(node));
}

int GraphBuilder::add(Node node) {
  Sha256 hash;
  hash.text("stage").text(node.type->name).integer(node.type->version);
  hash.text(node.parameters_text());
  for (const auto& [port, source] : node.sources) hash.text(port).text(graph_.nodes[source].key);
  node.key = hash.hex();
  graph_.nodes.push_back(std::move(node));
  return static_cast<int>(graph_.nodes.size()) - 1;
}

Graph make_graph(const config::CaseConfig& config, const std::string& input_hash, const HashOfScan& hash_of_scan) {
  return GraphBuilder(config, input_hash, hash_of_scan).build();
}

}  // namespace trephine::pipeline
