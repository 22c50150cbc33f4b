// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/values.h"

#include "base/joined.h"
#include "base/text.h"
#include "config/declared.h"

namespace trephine::config {
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

// The value's fault, told where the value was given.
Error fault_of_value(const std::string& path, const ValueOrigin& from, const std::string& what) {
  if (from.source == ValueSource::command_line) return Error(ExitCode::usage, "", "--set " + path, what);
  return Error(ExitCode::bad_config, from.where, path, what);
}

// The path of a parameter below a prefix. What the hand feels is named without the scene.
std::string path_below(const std::string& prefix, const std::string& name) {
  if (prefix == "scene" && name == "haptic") return name;
  return name.empty() ? prefix : prefix + "." + name;
}

// Checks a struct and all within it. Returns the strongest origin among values that were set after the files were read.
class SetValuesCheck {
 public:
  using FaultOfName = std::function<std::string(const std::string& kind, const std::string& name)>;
  SetValuesCheck(const ConfigValues& values, const FaultOfName& fault_of_name, ConfigFaults& faults)
      : values_(values), fault_of_name_(fault_of_name), faults_(faults) {}

  const ValueOrigin* check(const std::string& path, const ParameterSet& set, void* object) {
    const ValueOrigin* latest = nullptr;
    const auto note = [&](const ValueOrigin* origin) {
      if (origin && (!latest || origin->source > latest->source)) latest = origin;
    };
    for (const Parameter& p : set.parameters) {
      const std::string one = path_below(path, p.name);
      if (p.is_value())
        note(check_value(one, p, object));
      else
        for (const ParameterItem& item : p.items(object))
          note(check(path_below(one, item.name), p.set_of(item), item.object));
    }
    if (latest && set.fault)
      if (const std::string what = set.fault(object); !what.empty()) {
        const std::size_t colon = what.find(": ");
        const std::string key = colon == std::string::npos ? "" : what.substr(0, colon);
        faults_.add(fault_of_value(path_below(path, key), *latest, key.empty() ? what : what.substr(colon + 2)));
      }
    return latest;
  }

 private:
  const ValueOrigin* check_value(const std::string& path, const Parameter& p, const void* object) {
    if (!values_.is_set(path)) return nullptr;
    const ValueOrigin& origin = values_.origin(path);
    if (p.kind == ParameterKind::text && !p.source.empty()) {
      const std::string name = std::get<std::string>(p.get(object));
      const std::string what = name.empty() ? "" : fault_of_name_(p.source, name);
      if (!what.empty()) faults_.add(fault_of_value(path, origin, what));
    }
    return &origin;
  }

  const ConfigValues& values_;
  const FaultOfName& fault_of_name_;
  ConfigFaults& faults_;
};

bool ends_as(const std::string& path, const std::string& end) {
  return path.size() > end.size() && path.compare(path.size() - end.size(), end.size(), end) == 0 &&
         path[path.size() - end.size() - 1] == '.';
}

// The paths that were meant: those that end with the one given, or that it ends with; else one that is spelt nearly so.
std::string meant_instead(const std::string& path, const std::vector<std::string>& known) {
  constexpr std::size_t most = 4;
  std::vector<std::string> near;
  for (const std::string& one : known)
    if (ends_as(one, path) || ends_as(path, one)) near.push_back(one);
  if (!near.empty() && near.size() <= most) return ", did you mean " + listed(near, "or") + "?";
  const std::string spelt = did_you_mean(path, known);
  return !spelt.empty() ? spelt
                        : ", a path is anatomy.stage.parameter, import.parameter, scene.key or burr_hole_1.parameter";
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
    case ValueSource::library:
      return "library";
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

std::string ConfigValues::set(const std::string& path, const std::string& text, const ValueOrigin& from, bool explain) {
  const YamlNode value = value_of(text);
  const std::vector<std::string> paths = matching(path);
  if (paths.empty()) {
    if (!explain) return "no such parameter";
    std::vector<std::string> known;
    for (const auto& target : targets_) known.push_back(target.first);
    return "no such parameter" + meant_instead(path, known);
  }
  for (const std::string& one : paths) {
    if (const auto fixed = fixed_.find(one); fixed != fixed_.end()) return fixed->second;
    if (origin(one).source > from.source) continue;
    const Target& target = targets_.at(one);
    if (std::string fault = set_parameter(target.object, *target.parameter, value); !fault.empty()) return fault;
    note(one, from);
    set_.insert(one);
  }
  return "";
}

void ConfigValues::set_from_text(const std::string& text, const ValueOrigin& from, ConfigFaults& faults) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos)
    return faults.add(Error(ExitCode::usage, "", "--set", text + ", must be anatomy.stage.parameter=value"));
  const std::string path = text.substr(0, equals);
  if (const std::string fault = set(path, text.substr(equals + 1), from, !faults.full()); !fault.empty())
    faults.add(fault_of_value(path, from, fault));
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

void ConfigValues::check(
    const std::string& prefix, const AnyParams& params,
    const std::function<std::string(const std::string& kind, const std::string& name)>& fault_of_name,
    ConfigFaults& faults) const {
  SetValuesCheck(*this, fault_of_name, faults).check(prefix, *params.set, params.object.get());
}

std::vector<ValueRow> ConfigValues::rows() const {
  std::vector<ValueRow> all;
  for (const auto& [path, target] : targets_)
    all.push_back(
        {path, trephine::to_text(target.parameter->get(target.object)), origin(path), target.parameter->help});
  return all;
}

}  // namespace trephine::config
