// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/settings.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"
#include "base/text.h"
#include "config/config.h"
#include "config/declared.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

using Values = std::map<std::string, std::string>;

constexpr const char* key_prefix =
    "key ";  // stands for all settings of a node; never shown beside a single parameter of it

void add_graph(const pipeline::Graph& graph, Values& out) {
  for (const pipeline::Node& node : graph.nodes) {
    out[key_prefix + node.name] = node.key;
    out["stage " + node.name] = "version " + std::to_string(node.type->version);
    for (const auto& [name, value] : node.recorded()) out[node.name + "." + name] = to_text(value);
  }
}

template <class P>
void add_leaves(const std::string& prefix, const P& params, Values& out) {
  const AnyParams copy = AnyParams::make(params);
  for (const ParameterLeaf& leaf : leaves_of(copy)) out[prefix + "." + leaf.path] = to_text(leaf.value());
}

// What a person did, whose values say nothing to a reader: digests, and each number of a landmark by itself. Else "".
std::string in_words(const std::string& name) {
  constexpr std::string_view correction = ".correct.file", given = "given_landmarks.", landmarks = "landmarks.";
  std::string_view rest = name;
  if (rest.size() > correction.size() && rest.substr(rest.size() - correction.size()) == correction)
    return std::string(rest.substr(0, rest.size() - correction.size())) + ": its correction by hand changed";
  if (rest.substr(0, given.size()) == given) rest.remove_prefix(given.size());
  if (rest.substr(0, landmarks.size()) != landmarks) return "";
  rest.remove_prefix(landmarks.size());
  return "landmark " + std::string(rest.substr(0, rest.find('.'))) + " changed";
}

// A configuration that is not there has its place in LIBRARY.yaml, and often a neighbour that was meant.
void require_config(const LibraryCase& one) {
  std::error_code failed;
  if (one.config_at.empty() || fs::exists(one.config, failed)) return;
  std::vector<std::string> beside;
  for (fs::directory_iterator at(one.config.parent_path(), failed), end; !failed && at != end; at.increment(failed))
    beside.push_back(at->path().filename().string());
  throw Error(ExitCode::no_input, one.config_at, "config",
              one.config.string() + ", not found" + config::did_you_mean(one.config.filename().string(), beside));
}

}  // namespace

CaseSettings read_case_settings(const LibraryCase& one, const std::vector<fs::path>& roots, bool pictures,
                                const std::string& program_version, const pipeline::HashOfScan& hash_of_scan) {
  config::ConfigOverrides overrides;
  overrides.set = one.set;
  overrides.set_in_library = one.set_in_file;
  overrides.roots = roots;
  overrides.landmarks = one.landmarks;
  require_config(one);
  const config::CaseConfig config = config::read_case_config(one.config, overrides);
  CaseSettings out;
  out.series = config.series;
  out.import = config.import;
  add_graph(pipeline::make_graph(config, "", hash_of_scan), out.values);
  // What a scene sets besides the stages' parameters, and what publishes the case: none of it may be forgotten.
  for (const ParameterLeaf& leaf : leaves_of(config.scene_file))
    if (leaf.path != "materials") out.values["scene." + leaf.path] = to_text(leaf.value());
  for (const config::SceneShape& shape : config.haptic.shapes)
    add_leaves("materials." + shape.material.name, static_cast<const cases::MaterialParams&>(shape.material),
               out.values);
  std::string& order = out.values["recipe.order"];  // the case lists its anatomies in the recipe's order
  for (const config::RecipeAnatomy& anatomy : config.anatomies)
    if (config.is_shown(anatomy.name)) {
      order += (order.empty() ? "" : ", ") + anatomy.name;
      add_leaves("recipe.anatomies." + anatomy.name, static_cast<const config::RecipeAnatomyParams&>(anatomy),
                 out.values);
    }
  add_leaves("recipe", config.roles, out.values);
  if (!config.trade.rule.empty()) {
    out.values["trade.rule"] = config.trade.rule.text();
    out.values["trade.point"] = config.trade.choice.point.name;
  }
  for (const cases::CaseLandmark& l : config.landmarks)
    out.values["landmarks." + l.name] = to_text(l.position_mm.x) + ", " + to_text(l.position_mm.y) + ", " +
                                        to_text(l.position_mm.z) + ", " + l.source + " " + to_text(l.confidence);
  for (const config::CaseScan& scan : config.scans) {
    out.values["scans." + scan.name + ".modality"] = config::to_text(scan.modality);
    out.values["scans." + scan.name + ".same_patient_reason"] = scan.same_patient_reason;
  }
  out.values["pictures"] = pictures ? "true" : "false";
  out.values["program"] = program_version;
  out.values["case_format"] = cases::case_version();  // a case of another one is refused, and must be made again
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
    if (const std::string words = in_words(name); !words.empty()) {
      if (std::find(lines.begin(), lines.end(), words) == lines.end()) lines.push_back(words);
    } else if (name.rfind(key_prefix, 0) == 0)
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

}  // namespace trephine::library
