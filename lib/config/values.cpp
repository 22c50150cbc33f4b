// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/values.h"

#include "base/text.h"
#include "config/declared.h"

namespace trephine {
namespace {

YamlNode scalar(const std::string& text) {
  YamlNode node;
  node.kind = YamlNode::Kind::scalar;
  node.text = text;
  return node;
}

// One word, or words in a list: [words, in a list].
YamlNode value_of(const std::string& text) {
  if (text.size() < 2 || text.front() != '[' || text.back() != ']') return scalar(text);
  YamlNode list;
  list.kind = YamlNode::Kind::list;
  for (std::string& item : split_at(text.substr(1, text.size() - 2), ',')) {
    item.erase(0, item.find_first_not_of(' '));
    list.items.push_back(scalar(item));
  }
  return list;
}

}  // namespace

const char* to_text(ValueSource source) {
  switch (source) {
    case ValueSource::standard:
      return "default";
    case ValueSource::recipe:
      return "recipe";
    case ValueSource::trade:
      return "trade";
    case ValueSource::scene:
      return "scene";
    case ValueSource::set:
      return "set";
    case ValueSource::command_line:
      return "--set";
    case ValueSource::rule:
      return "rule";
  }
  return "";
}

void ConfigValues::add(const std::string& prefix, const AnyParams& params) {
  for (const ParameterLeaf& leaf : leaves_of(params)) add_one(prefix + "." + leaf.path, params, leaf);
}

const ValueOrigin& ConfigValues::origin(const std::string& path) const {
  static const ValueOrigin standard;
  const auto found = origins_.find(path);
  return found == origins_.end() ? standard : found->second;
}

// "*.decimate.keep_ratio" stands for that parameter of every anatomy: for all paths that end so and have one word
// before.
std::vector<std::string> ConfigValues::matching(const std::string& path) const {
  if (has(path)) return {path};
  std::vector<std::string> all;
  if (path.rfind("*.", 0) != 0) return all;
  const std::string end = path.substr(1);
  for (const auto& [name, target] : targets_)
    if (name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0 &&
        name.find('.') == name.size() - end.size())
      all.push_back(name);
  return all;
}

std::string ConfigValues::set(const std::string& path, const YamlNode& value, const ValueOrigin& from) {
  const std::vector<std::string> paths = matching(path);
  if (paths.empty()) {
    std::vector<std::string> known;
    for (const auto& target : targets_) known.push_back(target.first);
    const std::string near = did_you_mean(path, known);
    return "no such parameter" + (near.empty() ? ", a path is anatomy.stage.parameter or import.parameter" : near);
  }
  for (const std::string& one : paths) {
    if (origin(one).source > from.source) continue;
    const Target& target = targets_.at(one);
    if (std::string fault = set_parameter(target.object, *target.parameter, value); !fault.empty()) return fault;
    note(one, from);
  }
  return "";
}

void ConfigValues::set_from_text(const std::string& text, const ValueOrigin& from, ConfigFaults& faults) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos)
    return faults.add(Error(ExitCode::usage, "", "--set", text + ", must be anatomy.stage.parameter=value"));
  const std::string path = text.substr(0, equals);
  if (const std::string fault = set(path, value_of(text.substr(equals + 1)), from); !fault.empty())
    faults.add(Error(ExitCode::usage, "", "--set " + path, fault));
}

void ConfigValues::set_value(const std::string& path, const ParameterValue& value, const ValueOrigin& from) {
  const auto target = targets_.find(path);
  if (target == targets_.end() || origin(path).source > from.source) return;
  target->second.parameter->set(target->second.object, value);
  note(path, from);
}

double ConfigValues::number(const std::string& path, double where_absent) const {
  const auto found = targets_.find(path);
  if (found == targets_.end()) return where_absent;
  const ParameterValue value = found->second.parameter->get(found->second.object);
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  const auto* number = std::get_if<double>(&value);
  return number ? *number : where_absent;
}

std::vector<ValueRow> ConfigValues::rows() const {
  std::vector<ValueRow> all;
  for (const auto& [path, target] : targets_)
    all.push_back({path, to_text(target.parameter->get(target.object)), origin(path)});
  return all;
}

}  // namespace trephine
