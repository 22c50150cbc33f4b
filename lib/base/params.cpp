// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/params.h"

#include <cmath>
#include <set>

#include "base/joined.h"
#include "base/text.h"

namespace trephine {
namespace {

constexpr double unlimited = 1e12;  ///< a limit that only keeps sums finite is not worth a word

// A text such as " from 0 to 5" or " of at least 0", or nothing. Limits that are only those of the machine's integers
// are left out.
std::string limits(const Parameter& p, const char* from, const char* at_least, const char* at_most) {
  const auto bounded = [&](double v) {
    const bool whole = p.kind == ParameterKind::integer || p.whole;
    return std::fabs(v) < unlimited && (!whole || std::fabs(v) < 2147483647.0);
  };
  const auto text = [&](double v) {
    return p.kind == ParameterKind::integer && std::fabs(v) > 99999 ? grouped_text(static_cast<long long>(v))
                                                                    : to_text(v);
  };
  const bool below = bounded(p.range.min), above = bounded(p.range.max);
  if (below && above && p.range.min == p.range.max) return " " + text(p.range.min);
  if (below && above) return from + text(p.range.min) + " to " + text(p.range.max);
  if (below) return at_least + text(p.range.min);
  if (above) return at_most + text(p.range.max);
  return "";
}

std::string what_is_asked(const Parameter& p) {
  const std::string range = limits(p, " from ", " of at least ", " of at most ");
  switch (p.kind) {
    case ParameterKind::number:
      return "a number" + range;
    case ParameterKind::integer:
      return p.range.min == p.range.max ? to_text(p.range.min) : "a whole number" + range;
    case ParameterKind::flag:
      return "true or false";
    case ParameterKind::choice:
      return "one of " + joined(p.choices);
    case ParameterKind::text:
      return p.form ? p.form->what : "one text";
    case ParameterKind::any:
      return "a number, true or false, a text, or a list of numbers";
    case ParameterKind::numbers:
      return std::to_string(p.count) + (p.whole ? " whole numbers" : " numbers") +
             (range.empty() ? "" : ", each" + range);
    case ParameterKind::group:
      return "keys and values";
    case ParameterKind::list:
      return "a list";
    case ParameterKind::map:
      return "names, each with its values";
    case ParameterKind::steps:
      return "a list of steps: `- name` or `- name: {...}`";
  }
  return "";
}

bool in_range(const Parameter& p, double v) {
  return (v >= p.range.min && v <= p.range.max) || (p.zero_is_none && v == 0);
}

bool parse(const Parameter& p, const std::vector<std::string>& items, ParameterValue& value) {
  if (p.kind == ParameterKind::numbers) {
    if (items.size() != p.count) return false;
    std::vector<double> numbers;
    for (const auto& item : items) {
      const auto v = parse_number(item);
      if (!v || !in_range(p, *v) || (p.whole && !parse_integer(item))) return false;
      numbers.push_back(*v);
    }
    value = std::move(numbers);
    return true;
  }
  if (items.size() != 1) return false;
  const std::string& item = items[0];
  switch (p.kind) {
    case ParameterKind::number: {
      const auto v = parse_number(item);
      if (!v || !in_range(p, *v)) return false;
      value = *v;
      return true;
    }
    case ParameterKind::integer: {
      const auto v = parse_integer(item);
      if (!v || !in_range(p, static_cast<double>(*v))) return false;
      value = std::int64_t{*v};
      return true;
    }
    case ParameterKind::flag:
      if (item != "true" && item != "false") return false;
      value = item == "true";
      return true;
    case ParameterKind::choice:
      if (std::find(p.choices.begin(), p.choices.end(), item) == p.choices.end()) return false;
      value = item;
      return true;
    case ParameterKind::text:
      value = item;
      return !p.form || p.form->fits(item);
    default:
      break;
  }
  return false;
}

void add_leaves(const ParameterSet& set, void* object, const std::string& prefix, std::vector<ParameterLeaf>& out) {
  for (const Parameter& p : set.parameters) {
    const std::string path = p.name.empty() ? prefix : prefix.empty() ? p.name : prefix + "." + p.name;
    if (p.is_value()) {
      out.push_back({path, &p, object});
      continue;
    }
    for (const ParameterItem& item : p.items(object))
      add_leaves(p.set_of(item), item.object, item.name.empty() ? path : path + "." + item.name, out);
  }
}

void add_declared(const ParameterSet& set, const std::shared_ptr<void>& defaults, const std::string& prefix,
                  std::vector<DeclaredParameter>& out) {
  for (const Parameter& p : set.parameters) {
    const std::string path = p.name.empty() ? prefix : prefix.empty() ? p.name : prefix + "." + p.name;
    if (!p.name.empty() || p.is_value()) out.push_back({path, &p, defaults});
    if (p.is_value() || p.kind == ParameterKind::steps) continue;  // a step has a page of its own
    const ParameterSet& items = p.item_set();
    if (items.only_value() && items.only_value()->is_value()) continue;  // the line of the parameter itself says it
    add_declared(items, items.make(), path + (p.kind == ParameterKind::map ? ".NAME" : ""), out);
  }
}

// A text byte by byte, with its length, so that no two texts look alike.
std::string whole(const std::string& text) { return std::to_string(text.size()) + ":" + text; }

std::string text_of(const ParameterSet& set, void* object) {
  std::string text = "{";
  for (const Parameter& p : set.parameters) {
    text += p.name + ": ";
    if (p.is_value()) {
      const ParameterValue value = p.get(object);
      const auto* one = std::get_if<std::string>(&value);
      text += one ? whole(*one) : to_text(value);
    } else {
      text += "(";
      for (const ParameterItem& item : p.items(object))
        text += whole(item.name) + " " + text_of(p.set_of(item), item.object);
      text += ")";
    }
    text += "; ";
  }
  return text + "}";
}

// Splits "a=1,b=2,3" into {a, 1} and {b, 2,3}.
std::vector<std::pair<std::string, std::string>> keys_and_values(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> all;
  for (const std::string& part : split_at(text, ',')) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos && !all.empty())
      all.back().second += "," + part;
    else
      all.emplace_back(part.substr(0, equals), equals == std::string::npos ? "" : part.substr(equals + 1));
  }
  return all;
}

std::string set_from_text(const Parameter& p, void* object, const std::string& text) {
  if (!p.is_value()) return "cannot be given on a command line";
  ParameterValue value;
  const std::string fault = parse_parameter(
      p, p.kind == ParameterKind::numbers ? split_at(text, ',') : std::vector<std::string>{text}, value);
  if (fault.empty()) p.set(object, value);
  return fault;
}

std::string set_keys(const ParameterSet& set, void* object, const std::string& text) {
  for (const auto& [key, value] : keys_and_values(text)) {
    const Parameter* p = set.find(key);
    if (!p) {
      const std::string near = nearest_name(key, set.names());
      return key + ", no such key, " +
             (near.empty() ? "known are " + joined(set.names()) : "did you mean " + near + "?");
    }
    if (const std::string fault = set_from_text(*p, object, value); !fault.empty()) return key + ", " + fault;
  }
  return set.fault ? set.fault(object) : "";
}

}  // namespace

const TextForm some_text{"[^\\n]|\\n", "a text that is not empty",
                         [](const std::string& text) { return !text.empty(); }};

std::string to_text(const ParameterValue& value) {
  if (const auto* v = std::get_if<double>(&value)) return to_text(*v);
  if (const auto* v = std::get_if<std::int64_t>(&value)) return std::to_string(*v);
  if (const auto* v = std::get_if<bool>(&value)) return *v ? "true" : "false";
  if (const auto* v = std::get_if<std::string>(&value)) return in_quotes(*v);
  std::vector<std::string> items;
  for (const double v : std::get<std::vector<double>>(value)) items.push_back(to_text(v));
  return "[" + joined(items) + "]";
}

std::string parse_parameter(const Parameter& parameter, const std::vector<std::string>& items, ParameterValue& value) {
  if (parse(parameter, items, value)) return "";
  std::string fault = "must be " + what_is_asked(parameter);
  if (parameter.kind == ParameterKind::choice && items.size() == 1) {
    const std::string near = nearest_name(items[0], parameter.choices);
    if (!near.empty()) fault += "; did you mean " + near + "?";
  }
  return fault;
}

std::string fault_of(const Parameter& p, const ParameterValue& value) {
  const auto number = [&](double v) { return std::isfinite(v) && in_range(p, v); };
  bool sound = true;
  if (const auto* one = std::get_if<double>(&value)) sound = number(*one);
  if (const auto* one = std::get_if<std::int64_t>(&value)) sound = in_range(p, static_cast<double>(*one));
  if (const auto* all = std::get_if<std::vector<double>>(&value))
    sound = std::all_of(all->begin(), all->end(), number) && (p.kind == ParameterKind::any || all->size() == p.count);
  if (const auto* text = std::get_if<std::string>(&value)) {
    if (p.kind == ParameterKind::choice)
      sound = std::find(p.choices.begin(), p.choices.end(), *text) != p.choices.end();
    else
      sound = !p.form || p.form->fits(*text);
  }
  return sound ? "" : to_text(value).substr(0, 80) + ", must be " + what_is_asked(p);
}

std::string item_in_path(const std::string& name, std::size_t number) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), plain)
             ? "." + name
             : "[" + std::to_string(number) + "]";
}

std::string fault_of(const ParameterSet& set, void* object) {
  for (const Parameter& p : set.parameters) {
    if (p.is_value()) {
      if (is_absent(p, set, object)) continue;
      const ParameterValue value = p.get(object);
      if (const std::string fault = fault_of(p, value); !fault.empty())
        return p.name + (p.name.empty() ? "" : ": ") + fault;
      continue;
    }
    std::set<std::string> names;
    std::size_t number = 0;
    for (const ParameterItem& item : p.items(object)) {
      const ParameterSet& of_item = p.set_of(item);
      if (p.kind == ParameterKind::map && !names.insert(item.name).second)
        return p.name + ": " + in_quotes(item.name) + " is given twice";
      const Parameter* named = p.kind == ParameterKind::list ? of_item.find("name") : nullptr;
      const std::string name = named ? std::get<std::string>(named->get(item.object)) : item.name;
      const bool by_name = named || p.kind == ParameterKind::map;
      const std::string at = p.kind == ParameterKind::group ? "" : item_in_path(by_name ? name : "", number);
      ++number;
      if (const std::string fault = fault_of(of_item, item.object); !fault.empty())
        return p.name + at + (of_item.only_value() ? ": " : ".") + fault;
    }
  }
  return set.fault ? set.fault(object) : "";
}

std::string describe_parameter(const Parameter& p, const void* object) {
  const std::string range = limits(p, ", ", ", at least ", ", at most ");
  const auto value = [&] { return p.get(object); };
  const auto fallback = [&] {
    const ParameterValue v = value();
    const bool none = p.zero_is_none && (v == ParameterValue(0.0) || v == ParameterValue(std::int64_t{0}));
    if (p.required) return std::string(", required");
    if (none) return std::string(", default 0: none");
    if (p.kind == ParameterKind::choice && v == ParameterValue(std::string())) return std::string(", default: none");
    return ", default " + (p.kind == ParameterKind::choice ? std::get<std::string>(v) : to_text(v));
  };
  const ParameterSet* items = p.item_set ? &p.item_set() : nullptr;
  const Parameter* only = items ? items->only_value() : nullptr;
  const auto of_item = [&] {
    if (!only) return std::string();
    const std::shared_ptr<void> object_of_item = items->make();
    const std::string text = describe_parameter(*only, object_of_item.get());
    return ": " + text.substr(0, text.find(", default"));
  };
  const std::string most = p.count ? ", at most " + std::to_string(p.count) : "",
                    needed = p.required ? ", required" : "";
  switch (p.kind) {
    case ParameterKind::number:
      return "number" + range + fallback();
    case ParameterKind::integer:
      return "whole number" + range + fallback();
    case ParameterKind::flag:
      return "true or false" + fallback();
    case ParameterKind::choice:
      return "one of " + joined(p.choices) + fallback();
    case ParameterKind::text:
      return (p.form ? p.form->what : "text") + fallback();
    case ParameterKind::any:
      return "number, true or false, text, or list of numbers";
    case ParameterKind::numbers:
      return std::to_string(p.count) + (p.whole ? " whole numbers" : " numbers") + range + fallback();
    case ParameterKind::group:
      return "keys and values" + needed;
    case ParameterKind::list:
      return "list" + of_item() + most + needed;
    case ParameterKind::map:
      return "names" + of_item() + most + needed;
    case ParameterKind::steps: {
      std::vector<std::string> names;
      for (const StepChoice& step : p.steps) names.push_back(step.name);
      return "list of " + joined(names) + ", each alone or with its keys and values" + needed;
    }
  }
  return "";
}

std::string parse_item(const Parameter& p, void* params, const std::string& text) {
  const ParameterSet& set = p.item_set();
  std::string name, rest = text;
  if (p.kind == ParameterKind::map) {
    const std::size_t end = text.find_first_of(set.only_value() ? "=" : ":=");
    name = text.substr(0, end);
    if (name.empty() || (end != std::string::npos && text[end] == '=' && !set.only_value()))
      return "must be NAME, or NAME:KEY=VALUE,...";
    if (set.only_value() && end == std::string::npos) return "must be NAME=VALUE";
    rest = end == std::string::npos ? "" : text.substr(end + 1);
  }
  if (p.count > 0 && p.items(params).size() >= p.count) return "at most " + std::to_string(p.count) + " can be given";
  void* object = p.add(params, name);
  if (const Parameter* only = set.only_value()) return set_from_text(*only, object, rest);
  return rest.empty() ? "" : set_keys(set, object, rest);
}

std::vector<ParameterLeaf> leaves_of(const AnyParams& params) {
  std::vector<ParameterLeaf> all;
  if (params.set) add_leaves(*params.set, params.object.get(), "", all);
  return all;
}

std::vector<DeclaredParameter> declared_of(const AnyParams& defaults) {
  std::vector<DeclaredParameter> all;
  add_declared(*defaults.set, defaults.object, "", all);
  return all;
}

std::string to_text(const AnyParams& params) { return text_of(*params.set, params.object.get()); }

Parameter& Parameter::only_where(std::function<bool(const void*)> there) {
  items = [all = items, there = std::move(there)](void* q) { return there(q) ? all(q) : std::vector<ParameterItem>(); };
  return not_always();
}

const StepChoice* Parameter::find_step(const std::string& step) const {
  for (const StepChoice& c : steps)
    if (c.name == step) return &c;
  return nullptr;
}

bool ParameterSet::has_required() const {
  return std::any_of(parameters.begin(), parameters.end(), [](const Parameter& p) { return p.required; });
}

const Parameter* ParameterSet::find(const std::string& name) const {
  for (const Parameter& p : parameters)
    if (p.name == name) return &p;
  return nullptr;
}

const Parameter* ParameterSet::only_value() const {
  return parameters.size() == 1 && parameters[0].name.empty() ? &parameters[0] : nullptr;
}

std::vector<std::string> ParameterSet::names() const {
  std::vector<std::string> names;
  for (const Parameter& p : parameters) names.push_back(p.name);
  return names;
}

}  // namespace trephine
