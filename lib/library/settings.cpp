// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/settings.h"

#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "base/hash.h"
#include "base/text.h"
#include "pipeline/config.h"
#include "pipeline/graph.h"
#include "pipeline/yaml_document.h"

namespace trephine {
namespace fs = std::filesystem;
namespace {

using Values = std::map<std::string, std::string>;

constexpr const char* key_prefix = "key ";  // what stands for all of a node; never shown beside a parameter of it

void flatten(const YamlNode& node, const std::string& path, const std::set<std::string>& without, Values& out) {
  if (without.count(path)) return;
  switch (node.kind) {
    case YamlNode::Kind::null:
      out[path] = "";
      break;
    case YamlNode::Kind::scalar:
      out[path] = node.text;
      break;
    case YamlNode::Kind::list:
      out[path] = std::to_string(node.items.size()) + " items";
      for (std::size_t i = 0; i < node.items.size(); ++i)
        flatten(node.items[i], path + "[" + std::to_string(i) + "]", without, out);
      break;
    case YamlNode::Kind::map:
      if (node.entries.empty()) out[path] = "{}";
      for (const auto& [key, value] : node.entries) flatten(value, path + "." + key.text, without, out);
      break;
  }
}

fs::path file_of(const fs::path& from, const YamlNode& tree, const char* key) {
  const YamlNode* node = tree.find(key);
  return node ? from.parent_path() / node->text : fs::path();
}

void add_graph(const Graph& graph, Values& out) {
  for (const Node& node : graph.nodes) {
    out[key_prefix + node.name] = node.key;
    if (node.type) out["stage " + node.name] = "version " + std::to_string(node.type->version);
    if (!node.salt.empty()) out[node.name + " (made from)"] = sha256_of_bytes(node.salt).substr(0, 16);
    if (!node.params.set) continue;
    for (const Parameter& p : node.params.set->parameters) out[node.name + "." + p.name] = to_text(node.recorded(p));
  }
}

// Of the recipe what is not in the graph: colours and the like, of the anatomies that the case shows.
void add_recipe(const YamlNode& tree, const CaseConfig& config, Values& out) {
  const YamlNode* anatomies = tree.find("anatomies");
  if (!anatomies) return;
  for (const auto& [key, value] : anatomies->entries) {
    const std::string path = "recipe.anatomies." + key.text;
    if (config.is_shown(key.text)) flatten(value, path, {path + ".stages"}, out);
  }
}

void add_materials(const YamlNode& scene, const fs::path& scene_file, const CaseConfig& config, Values& out) {
  const fs::path file = file_of(scene_file, scene, "materials");
  if (file.empty() || !config.haptic.wanted) return;
  const YamlNode tree = read_yaml(file);
  const YamlNode* materials = tree.find("materials");
  if (!materials) return;
  for (const SceneShape& shape : config.haptic.shapes)
    if (const YamlNode* m = materials->find(shape.material.name))
      flatten(*m, "materials." + shape.material.name, {}, out);
}

}  // namespace

CaseSettings read_case_settings(const LibraryCase& one, const std::vector<fs::path>& roots, bool pictures,
                                const std::string& program_version) {
  ConfigOverrides overrides;
  overrides.set = one.set;
  overrides.roots = roots;
  overrides.landmarks = one.landmarks;
  const CaseConfig config = read_case_config(one.config, overrides);
  CaseSettings out;
  out.series = config.series;
  out.import = config.import;
  add_graph(make_graph(config, ""), out.values);
  const YamlNode tree = read_yaml(one.config);
  flatten(tree, "config",
          {"config.case", "config.series", "config.pipeline", "config.scene", "config.landmarks_file", "config.set"},
          out.values);
  const fs::path scene_file = file_of(one.config, tree, "scene");
  const YamlNode scene = read_yaml(scene_file);
  flatten(scene, "scene", {"scene.materials"}, out.values);
  for (const Parameter& p : config.scene_params.set->parameters)
    out.values["scene." + p.name] = to_text(config.scene_params.get(p));
  add_materials(scene, scene_file, config, out.values);
  add_recipe(read_yaml(file_of(one.config, tree, "pipeline")), config, out.values);
  for (const CaseLandmark& l : config.landmarks)
    out.values["landmarks." + l.name] = to_text(l.position_mm.x) + ", " + to_text(l.position_mm.y) + ", " +
                                        to_text(l.position_mm.z) + ", " + l.source + " " + to_text(l.confidence);
  out.values["pictures"] = pictures ? "true" : "false";
  out.values["program"] = program_version;
  out.sha256 = sha256_of_bytes(settings_json(out));
  return out;
}

std::string settings_json(const CaseSettings& settings) { return nlohmann::json(settings.values).dump(1) + "\n"; }

std::map<std::string, std::string> parse_settings_json(std::string_view json) {
  try {
    return nlohmann::json::parse(json.begin(), json.end()).get<Values>();
  } catch (const nlohmann::json::exception& e) {
    throw Error(ExitCode::bad_input, "", "json", e.what());
  }
}

std::vector<std::string> explain_difference(const Values& before, const Values& now) {
  std::vector<std::string> lines, keys;
  const auto add = [&](const std::string& name, const std::string& what) {
    if (name.rfind(key_prefix, 0) == 0)
      keys.push_back(name.substr(std::string(key_prefix).size()) + ": what it is made from differs");
    else
      lines.push_back(name + ": " + what);
  };
  for (const auto& [name, value] : now) {
    const auto old = before.find(name);
    if (old == before.end())
      add(name, value + ", is new");
    else if (old->second != value)
      add(name, value + ", was " + old->second);
  }
  for (const auto& [name, value] : before)
    if (!now.count(name)) add(name, "is no more, was " + value);
  return lines.empty() ? keys : lines;
}

}  // namespace trephine
