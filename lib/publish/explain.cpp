// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/joined.h"
#include "base/text.h"
#include "base/text_table.h"

namespace trephine::publish {
namespace {

// Predicts what the executor will do, without doing it (executor.cpp, demand).
class Forecast {
 public:
  Forecast(const pipeline::Graph& graph, const std::vector<int>& wanted, const pipeline::StageCache& cache)
      : graph_(graph), entries_(graph.nodes.size()), needed_(graph.nodes.size(), false) {
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) entries_[i] = cache.look_up(graph.nodes[i].key);
    for (const int w : wanted) demand(w);
    for (std::size_t i = graph.nodes.size(); i-- > 0;)
      if (!entries_[i].has_result) demand(static_cast<int>(i));
  }

  Explanation::Stage::State state(std::size_t i) const {
    using State = Explanation::Stage::State;
    if (!needed_[i]) return State::known;
    return is_cached(i) ? State::cached : State::compute;
  }
  std::optional<double> seconds(std::size_t i) const { return entries_[i].seconds; }

 private:
  bool is_cached(std::size_t i) const {
    return entries_[i].has_result && (entries_[i].has_data || graph_.nodes[i].output == stages::DataKind::nothing);
  }
  void demand(int node) {
    const auto i = static_cast<std::size_t>(node);
    if (needed_[i]) return;
    needed_[i] = true;
    if (is_cached(i)) return;
    for (const auto& [port, source] : graph_.nodes[i].sources) demand(source);
  }

  const pipeline::Graph& graph_;
  std::vector<pipeline::StageCache::Entry> entries_;
  std::vector<bool> needed_;
};

std::string why_needed(const pipeline::Graph& graph, int node, bool pictured) {
  std::vector<std::string> why, readers;
  if (pictured && graph.scan == node) why.emplace_back("the pictures");
  if (const std::string& serves = graph.nodes[std::size_t(node)].serves; !serves.empty()) why.push_back(serves);
  for (const pipeline::Node& reader : graph.nodes)
    for (const auto& [port, source] : reader.sources)
      if (source == node && std::find(readers.begin(), readers.end(), reader.name) == readers.end())
        readers.push_back(reader.name);
  if (!readers.empty()) why.push_back("read by " + joined(readers));
  if (graph.nodes[std::size_t(node)].type->runs_program)
    why.emplace_back("runs a program, which --allow-external must allow");
  return joined(why, "; ");
}

std::string why_pruned(const config::CaseConfig& config, const config::RecipeAnatomy& anatomy) {
  if (config.find_shown(anatomy.name))
    return "nothing of the scene reads it";  // no recipe of one chain has such a step
  if (config.is_felt(anatomy.name)) return "the scene feels " + anatomy.name + " but has no surface of it";
  return "the scene neither shows nor feels " + anatomy.name;
}

std::string why_scan_step_pruned(const config::CaseConfig& config, const stages::StageType& type) {
  if (type.in_every_recipe)
    return type.output == stages::DataKind::nothing ? "it is not set what the scan is of, so nothing is asked of it"
                                                    : "no spacing is set, the scan stays as it is";
  if (type.output == stages::DataKind::landmarks) return "nothing in the scene needs a landmark";
  if (type.effect == stages::StageEffect::removes_face)
    return config.face.empty() ? "the scene has no face policy" : "the scene's face policy is " + config.face;
  return "the scene shows too few of its anatomies";
}

bool begins_with(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }

// Whether the value has a part in this case: it belongs to a stage that will exist (for a node that sees the original
// scan, to its stage), to the scene, to an anatomy or a material that the scene has, or it is a role that is given.
bool is_shown(const config::ValueRow& row, const config::CaseConfig& config, const pipeline::Graph& graph) {
  if (begins_with(row.path, "scene.")) return true;
  for (const pipeline::Node& node : graph.nodes)
    if (begins_with(row.path, node.output == stages::DataKind::haptic ? "haptic." : node.name + ".")) return true;
  for (const config::SceneShape& shape : config.haptic.shapes)
    if (begins_with(row.path, "materials." + shape.material.name + ".")) return true;
  const AnyParams roles = AnyParams::make(config.roles);
  for (const ParameterLeaf& leaf : leaves_of(roles))
    if (leaf.path == row.path) return row.origin.source != config::ValueSource::standard;
  const std::size_t dot = row.path.find('.');
  return dot != std::string::npos && row.path.find('.', dot + 1) == std::string::npos &&
         config.find_anatomy(row.path.substr(0, dot)) && config.is_shown(row.path.substr(0, dot));
}

const char* to_text(Explanation::Stage::State state) {
  switch (state) {
    case Explanation::Stage::State::compute:
      return "compute";
    case Explanation::Stage::State::cached:
      return "cached";
    case Explanation::Stage::State::known:
      return "known";
  }
  return "";
}

}  // namespace

Explanation explain(const config::CaseConfig& config, const pipeline::Graph& graph, const std::vector<int>& wanted,
                    const pipeline::StageCache& cache) {
  Explanation out;
  out.trade = config.trade;
  for (const config::ValueRow& row : config.values)
    if (is_shown(row, config, graph)) out.values.push_back(row);
  const Forecast forecast(graph, wanted, cache);
  const bool pictured =
      std::count(wanted.begin(), wanted.end(), graph.scan) > graph.nodes[std::size_t(graph.scan)].wanted;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i)
    out.stages.push_back({graph.nodes[i].name, forecast.state(i), forecast.seconds(i),
                          why_needed(graph, static_cast<int>(i), pictured)});
  for (const config::RecipeStep& step : config.scan_steps)
    if (graph.find(step.type->name) < 0)
      out.pruned.push_back({step.type->name, why_scan_step_pruned(config, *step.type)});
  for (const config::RecipeAnatomy& anatomy : config.anatomies)
    for (const config::RecipeStep& step : anatomy.steps)
      if (const std::string name = anatomy.name + "." + step.type->name; graph.find(name) < 0)
        out.pruned.push_back({name, why_pruned(config, anatomy)});
  if (!config.haptic.wanted) out.pruned.push_back({"haptic.voxelize", "the scene wants no haptic volume"});
  return out;
}

namespace {

// The values that a source sets, then the count of those that are defaults.
std::string values_table(const std::vector<config::ValueRow>& values) {
  std::vector<std::vector<std::string>> cells = {{"parameter", "value", "from", "where"}};
  std::size_t defaults = 0;
  for (const config::ValueRow& row : values) {
    defaults += row.origin.source == config::ValueSource::standard;
    cells.push_back({row.path, row.value, config::to_text(row.origin.source), row.origin.where});
  }
  return text_table(cells, "llll") + fmt::format("{} parameters, {} at their defaults\n", values.size(), defaults);
}

}  // namespace

std::string explanation_table(const Explanation& e) {
  std::size_t width = 5;
  for (const auto& s : e.stages) width = std::max(width, s.name.size());
  for (const auto& p : e.pruned) width = std::max(width, p.name.size());
  std::string text = fmt::format("{:<{}}  {:<8} {:>9}  why\n", "stage", width, "state", "seconds");
  double to_compute = 0;
  std::size_t computed = 0, unknown = 0;
  for (const auto& s : e.stages) {
    text += fmt::format("{:<{}}  {:<8} {:>9}  {}\n", s.name, width, to_text(s.state),
                        s.seconds ? fmt::format("{:.2f}", *s.seconds) : "?", s.why);
    if (s.state != Explanation::Stage::State::compute) continue;
    ++computed;
    unknown += !s.seconds;
    to_compute += s.seconds.value_or(0);
  }
  for (const auto& p : e.pruned) text += fmt::format("{:<{}}  {:<8} {:>9}  {}\n", p.name, width, "pruned", "", p.why);
  text += fmt::format("{} of {} stages to compute, {} pruned", computed, e.stages.size(), e.pruned.size());
  if (computed > unknown)
    text += fmt::format("; {:.1f} s when they were last computed{}", to_compute,
                        unknown ? fmt::format(", without {} never seen", unknown) : "");
  text += '\n';
  text += "\n" + values_table(e.values);
  if (!e.trade.rule.empty())
    text += e.trade.rule.text() + ": point " + e.trade.choice.point.name + ", " + e.trade.choice.why + '\n';
  return text;
}

std::string explanation_json(const Explanation& e) {
  nlohmann::ordered_json json;
  json["stages"] = nlohmann::ordered_json::array();
  for (const auto& s : e.stages) {
    nlohmann::ordered_json stage{{"name", s.name}, {"state", to_text(s.state)}, {"why", s.why}};
    if (s.seconds) stage["seconds"] = *s.seconds;
    json["stages"].push_back(std::move(stage));
  }
  json["pruned"] = nlohmann::ordered_json::array();
  for (const auto& p : e.pruned) json["pruned"].push_back({{"name", p.name}, {"why", p.why}});
  json["parameters"] = nlohmann::ordered_json::array();
  for (const config::ValueRow& row : e.values)
    json["parameters"].push_back({{"path", row.path},
                                  {"value", row.value},
                                  {"from", config::to_text(row.origin.source)},
                                  {"where", row.origin.where}});
  if (!e.trade.rule.empty())
    json["trade"] = {{"rule", e.trade.rule.text()}, {"point", e.trade.choice.point.name}, {"why", e.trade.choice.why}};
  return json.dump(2) + "\n";
}

}  // namespace trephine::publish
