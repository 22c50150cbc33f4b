// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/config_paths.h"

#include <algorithm>

#include "base/text.h"

namespace trephine {
namespace fs = std::filesystem;
namespace {

YamlNode scalar(const std::string& text) {
  YamlNode node;
  node.kind = YamlNode::Kind::scalar;
  node.text = text;
  node.text.erase(0, node.text.find_first_not_of(' '));
  return node;
}

// A word, or [words, in a list].
YamlNode value_of(const std::string& text) {
  if (text.size() < 2 || text.front() != '[' || text.back() != ']') {
    YamlNode node = scalar("");
    node.text = text;
    return node;
  }
  YamlNode list;
  list.kind = YamlNode::Kind::list;
  const std::string items = text.substr(1, text.size() - 2);
  for (std::size_t at = 0; at != std::string::npos;) {
    const std::size_t comma = items.find(',', at);
    list.items.push_back(scalar(items.substr(at, comma == std::string::npos ? comma : comma - at)));
    at = comma == std::string::npos ? comma : comma + 1;
  }
  return list;
}

}  // namespace

std::map<std::string, ConfigPaths::Target> ConfigPaths::targets() const {
  std::map<std::string, Target> all;
  const auto add = [&](const std::string& prefix, AnyParams& params) {
    for (const Parameter& p : params.set->parameters) all[prefix + "." + p.name] = {&params, &p};
  };
  add("import", import_);
  add("scene", config_.scene_params);
  if (config_.haptic.wanted) add("haptic", config_.haptic.params);
  for (CaseDrill& hole : config_.burr_holes) add(hole.name, hole.params);
  for (RecipeAnatomy& anatomy : config_.anatomies)
    for (RecipeStep& step : anatomy.steps) add(anatomy.name + "." + step.type->name, step.params);
  for (RecipeStep& step : config_.head) add(step.type->name, step.params);
  return all;
}

std::optional<fs::path> ConfigPaths::set_in(const std::string& path) const {
  const auto found = set_in_.find(path);
  return found == set_in_.end() ? std::nullopt : std::optional<fs::path>(found->second);
}

std::string ConfigPaths::set(const std::string& path, const YamlNode& value, const fs::path& said_in) {
  const auto all = targets();
  if (const auto found = all.find(path); found != all.end()) {
    set_in_[path] = said_in;
    return set_parameter(*found->second.params, *found->second.parameter, value);
  }
  if (config_.anatomies.empty()) return "";
  if (path.rfind("*.", 0) == 0) {
    bool any = false;
    for (const RecipeAnatomy& anatomy : config_.anatomies)
      if (const auto found = all.find(anatomy.name + path.substr(1)); found != all.end()) {
        any = true;
        set_in_[found->first] = said_in;
        if (auto fault = set_parameter(*found->second.params, *found->second.parameter, value); !fault.empty())
          return fault;
      }
    if (any) return "";
  }
  std::vector<std::string> known;
  for (const auto& target : all) known.push_back(target.first);
  const std::string near = nearest_name(path, known);
  return "no such parameter" +
         (near.empty() ? ", a path is anatomy.stage.parameter or import.parameter" : ", did you mean " + near + "?");
}

void ConfigPaths::set_from_text(const std::string& text, ConfigFaults& faults) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos)
    return faults.add(Error(ExitCode::usage, "", "--set", text + ", must be anatomy.stage.parameter=value"));
  const std::string path = text.substr(0, equals);
  if (const std::string fault = set(path, value_of(text.substr(equals + 1)), {}); !fault.empty())
    faults.add(Error(ExitCode::usage, "", "--set " + path, fault));
}

}  // namespace trephine
