// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/declared.h"

#include <algorithm>

#include "base/joined.h"
#include "base/text.h"

namespace trephine::config {
namespace {

using Kind = YamlNode::Kind;

constexpr std::size_t max_keys = 10000;

class Reader {
 public:
  explicit Reader(const DeclaredReading& reading) : r_(reading) {}

  Places read(const YamlNode& tree, const ParameterSet& set, void* object) {
    places_.add("", tree);
    read_struct(tree, "", set, object);
    return std::move(places_);
  }

 private:
  void read_struct(const YamlNode& node, const std::string& where, const ParameterSet& set, void* object) {
    if (const Parameter* only = set.only_value()) return read_parameter(node, where, *only, object);
    if (node.kind != Kind::map) return fault(node, where, shown(node) + "must hold keys and values" + keys_of(set));
    const std::size_t before = r_.faults.count();
    for (const auto& [key, value] : node.entries)
      if (!set.find(key.text))
        fault(key, below(where, key.text), r_.faults.full() ? "unknown key" : unknown(key.text, set));
    // In the order of declaration, so that what names something is read after it.
    for (const Parameter& p : set.parameters) {
      const auto entry = std::find_if(node.entries.begin(), node.entries.end(),
                                      [&](const auto& one) { return one.first.text == p.name; });
      if (entry == node.entries.end()) {
        if (p.required) fault(node, below(where, p.name), "is missing: " + p.help);
        continue;
      }
      places_.add(below(where, p.name), entry->second, &entry->first);
      read_parameter(entry->second, below(where, p.name), p, object);
    }
    // Not checked where a value was refused already: the default in its place is not the user's fault.
    if (!set.fault || r_.faults.count() != before) return;
    const std::string what = set.fault(object);
    const std::size_t colon = what.find(": ");
    if (what.empty()) return;
    if (colon == std::string::npos) return fault(node, where, what);
    const std::string key = what.substr(0, colon);
    const YamlNode* at = node.find(key.substr(0, key.find('.')));
    fault(at ? *at : node, below(where, key), what.substr(colon + 2));
  }

  static std::string below(const std::string& where, const std::string& key) {
    return where.empty() || key.empty() ? where + key : where + "." + key;
  }
  static std::string shown(const YamlNode& node) {
    return node.kind == Kind::scalar && !node.text.empty() ? node.text + ", " : "";
  }
  static std::string keys_of(const ParameterSet& set) {
    const std::string all = joined(set.names(), ": ..., ");
    return all.empty() || all.size() > 60 ? "" : ": {" + all + ": ...}";
  }
  static std::string unknown(const std::string& key, const ParameterSet& set) {
    const std::vector<std::string> known = set.names();
    const std::string near = nearest_name(key, known);
    return "unknown key, " + (near.empty() ? "known are " + joined(known) : "did you mean " + near + "?");
  }

  void fault(const YamlNode& at, const std::string& where, const std::string& what) {
    r_.faults.add(r_.file, at, where, what);
  }
  void say(const std::string& path, const YamlNode& at) {
    if (r_.said) r_.said(path, at);
  }

  void read_parameter(const YamlNode& value, const std::string& where, const Parameter& p, void* object) {
    switch (p.kind) {
      case ParameterKind::group:
        return read_struct(value, where, p.item_set(), p.add(object, ""));
      case ParameterKind::steps:
        return read_steps(value, where, p, object);
      case ParameterKind::list:
        return read_list(value, where, p, object);
      case ParameterKind::map:
        return read_map(value, where, p, object);
      default:
        read_value(value, where, p, object);
    }
  }

  void read_value(const YamlNode& value, const std::string& where, const Parameter& p, void* object) {
    if (const std::string what = set_parameter(object, p, value); !what.empty()) return fault(value, where, what);
    say(where, value);
    if (!p.source.empty() && !value.text.empty()) check_name(value, where, p.source);
  }

  void check_name(const YamlNode& at, const std::string& where, const std::string& kind) {
    if (kind == "name" && !is_plain_name(at.text)) return fault(at, where, "a name has letters a-z, digits and _ only");
    if (!r_.fault_of_name) return;
    if (const std::string what = r_.fault_of_name(kind, at.text); !what.empty()) fault(at, where, what);
  }

  void read_list(const YamlNode& value, const std::string& where, const Parameter& p, void* object) {
    const bool bare = value.kind == Kind::scalar && p.item_set().only_value();
    if (value.kind != Kind::list && !bare) return fault(value, where, shown(value) + "must be a list");
    if (p.count && value.items.size() > p.count) return fault(value, where, "at most " + std::to_string(p.count));
    p.clear(object);
    if (bare) return read_struct(value, where, p.item_set(), p.add(object, ""));
    for (std::size_t i = 0; i < value.items.size(); ++i) {
      const std::string path = where + "[" + std::to_string(i) + "]";
      places_.add(path, value.items[i]);
      read_struct(value.items[i], path, p.item_set(), p.add(object, ""));
    }
  }

  // Each item is `- name` or `- name: {...}`.
  void read_steps(const YamlNode& value, const std::string& where, const Parameter& p, void* object) {
    if (value.kind != Kind::list) return fault(value, where, shown(value) + "must be a list");
    p.clear(object);
    for (const YamlNode& item : value.items) {
      const bool bare = item.kind == Kind::scalar;
      if (!bare && (item.kind != Kind::map || item.entries.size() != 1)) {
        fault(item, where, "each item is `- name` or `- name: {...}`");
        continue;
      }
      const YamlNode& name = bare ? item : item.entries[0].first;
      const std::string path = below(where, name.text);
      const StepChoice* step = p.find_step(name.text);
      if (!step || places_.has(path)) {
        std::vector<std::string> known;
        for (const StepChoice& s : p.steps) known.push_back(s.name);
        fault(name, where,
              name.text + (step ? ", is there already" : ", no such step" + did_you_mean(name.text, known)));
        continue;
      }
      YamlNode nothing = name;
      nothing.kind = Kind::map;
      const bool empty = bare || item.entries[0].second.kind == Kind::null;
      places_.add(path, empty ? name : item.entries[0].second, &name);
      read_struct(empty ? nothing : item.entries[0].second, path, *step->set, p.add(object, name.text));
    }
  }

  void read_map(const YamlNode& value, const std::string& where, const Parameter& p, void* object) {
    if (value.kind != Kind::map) return fault(value, where, shown(value) + "must hold keys and values");
    if (p.count && value.entries.size() > p.count) return fault(value, where, "at most " + std::to_string(p.count));
    if (p.required && value.entries.empty()) return fault(value, where, "names none");
    if (value.entries.size() > max_keys)  // each is sought among those before it
      return fault(
          value, where,
          std::to_string(value.entries.size()) + " keys, no configuration has more than " + std::to_string(max_keys));
    p.clear(object);
    for (const auto& [key, item] : value.entries) {
      const std::string path = below(where, key.text);
      const std::size_t before = r_.faults.count();
      if (!p.source.empty()) check_name(key, path, p.source);
      if (r_.faults.count() != before) continue;
      places_.add(path, item, &key);
      void* one = p.add(object, key.text);
      // A key without a value, such as `skull:`, has the defaults, unless something must be said.
      const bool nothing = item.kind == Kind::null && !p.item_set().only_value() && !p.item_set().has_required();
      if (!nothing) read_struct(item, path, p.item_set(), one);
    }
  }

  const DeclaredReading& r_;
  Places places_;
};

// A list as the text that --set takes.
std::string list_text(const YamlNode& value) { return "[" + joined(value.items, ", ", &YamlNode::text) + "]"; }

bool is_list_of_scalars(const YamlNode& value) {
  return value.kind == Kind::list && std::all_of(value.items.begin(), value.items.end(),
                                                 [](const YamlNode& item) { return item.kind == Kind::scalar; });
}

}  // namespace

void Places::add(const std::string& path, const YamlNode& value, const YamlNode* key) { places_[path] = {&value, key}; }

const Places::Place& Places::find(std::string path) const {
  for (;;) {
    if (const auto found = places_.find(path); found != places_.end()) return found->second;
    const std::size_t end = path.find_last_of(".[");
    path.resize(end == std::string::npos ? 0 : end);
  }
}

const YamlNode& Places::at(const std::string& path) const { return *find(path).value; }

const YamlNode& Places::key(const std::string& path) const {
  const Place& place = find(path);
  return place.key ? *place.key : *place.value;
}

Places read_declared(const DeclaredReading& reading, const YamlNode& tree, const ParameterSet& set, void* object) {
  return Reader(reading).read(tree, set, object);
}

bool is_plain_name(const std::string& text) {
  return !text.empty() && text.size() <= 32 && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

std::string set_parameter(void* object, const Parameter& parameter, const YamlNode& value) {
  if (parameter.source == "value" && is_list_of_scalars(value)) {
    parameter.set(object, list_text(value));
    return "";
  }
  std::vector<std::string> items;
  std::string shown;
  const bool is_list = value.kind == Kind::list;
  // An editor that follows the schema takes "1" for a text, and so does the program.
  const auto is_quoted = [](const YamlNode& one) { return one.quoted; };
  const bool wants_text = parameter.kind == ParameterKind::text || parameter.kind == ParameterKind::choice;
  const bool quoted = !wants_text && (value.quoted || std::any_of(value.items.begin(), value.items.end(), is_quoted));
  if (value.kind == Kind::scalar) items.push_back(shown = value.text);
  for (const YamlNode& item : value.items) items.push_back(item.text);
  ParameterValue parsed;
  std::string fault;
  if (parameter.source == "value" && value.kind != Kind::scalar)
    fault = value.kind == Kind::null
                ? "must be a value or a list of values, and there is none; a decimal number has a point, no comma: 0.3"
                : "must be a value or a list of values";
  else if (is_list != (parameter.kind == ParameterKind::numbers) || (!is_list && value.kind != Kind::scalar))
    fault = parse_parameter(parameter, {}, parsed);  // no item fits: the text says what does
  else
    fault = parse_parameter(parameter, items, parsed);
  if (fault.empty() && quoted) fault = parse_parameter(parameter, {}, parsed) + ", without quotes";
  if (!fault.empty()) return (shown.empty() ? "" : shown + ", ") + fault;
  parameter.set(object, parsed);
  return "";
}

std::string did_you_mean(const std::string& name, const std::vector<std::string>& known) {
  const std::string near = nearest_name(name, known);
  return near.empty() ? "" : ", did you mean " + near + "?";
}

}  // namespace trephine::config
