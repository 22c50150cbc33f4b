// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/params.h"

#include <cmath>

#include "base/text.h"

namespace trephine {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : printable(text)) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string joined(const std::vector<std::string>& items) {
  std::string out;
  for (const auto& item : items) out += (out.empty() ? "" : ", ") + item;
  return out;
}

// " from 0 to 5", " of at least 0", or nothing; the limits of the machine's integers are nobody's concern.
std::string limits(const Parameter& p, const char* from, const char* at_least, const char* at_most) {
  const auto bounded = [&](double v) {
    return std::isfinite(v) && (p.kind != ParameterKind::integer || std::fabs(v) < 2147483647.0);
  };
  const bool below = bounded(p.range.min), above = bounded(p.range.max);
  if (below && above) return from + to_text(p.range.min) + " to " + to_text(p.range.max);
  if (below) return at_least + to_text(p.range.min);
  if (above) return at_most + to_text(p.range.max);
  return "";
}

std::string what_is_asked(const Parameter& p) {
  const std::string range = limits(p, " from ", " of at least ", " of at most ");
  switch (p.kind) {
    case ParameterKind::number:
      return "a number" + range;
    case ParameterKind::integer:
      return "a whole number" + range;
    case ParameterKind::flag:
      return "true or false";
    case ParameterKind::choice:
      return "one of " + joined(p.choices);
    case ParameterKind::text:
      return "one text";
    case ParameterKind::numbers:
      return std::to_string(p.count) + " numbers" + (range.empty() ? "" : ", each" + range);
  }
  return "";
}

bool in_range(const Range& range, double v) { return v >= range.min && v <= range.max; }

bool parse(const Parameter& p, const std::vector<std::string>& items, ParameterValue& value) {
  if (p.kind == ParameterKind::numbers) {
    if (items.size() != p.count) return false;
    std::vector<double> numbers;
    for (const auto& item : items) {
      const auto v = parse_number(item);
      if (!v || !in_range(p.range, *v)) return false;
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
      if (!v || !in_range(p.range, *v)) return false;
      value = *v;
      return true;
    }
    case ParameterKind::integer: {
      const auto v = parse_integer(item);
      if (!v || !in_range(p.range, static_cast<double>(*v))) return false;
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
      return true;
    case ParameterKind::numbers:
      break;
  }
  return false;
}

}  // namespace

std::string to_text(const ParameterValue& value) {
  if (const auto* v = std::get_if<double>(&value)) return to_text(*v);
  if (const auto* v = std::get_if<std::int64_t>(&value)) return std::to_string(*v);
  if (const auto* v = std::get_if<bool>(&value)) return *v ? "true" : "false";
  if (const auto* v = std::get_if<std::string>(&value)) return quoted(*v);
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

std::string other_defaults(const Parameter& p, const ParameterValue& default_value) {
  std::vector<std::string> others;
  const auto text = [](const ParameterValue& v) {
    const auto* choice = std::get_if<std::string>(&v);
    return choice ? *choice : to_text(v);
  };
  for (const auto& [choice, value] : p.defaults_by)
    if (value != default_value) others.push_back(text(value) + " with " + choice);
  return joined(others);
}

std::string describe_parameter(const Parameter& p, const ParameterValue& default_value) {
  const std::string range = limits(p, ", ", ", at least ", ", at most ");
  const std::string others = other_defaults(p, default_value), also = others.empty() ? "" : " (" + others + ")";
  const std::string fallback = ", default " + to_text(default_value) + also;
  switch (p.kind) {
    case ParameterKind::number:
      return "number" + range + fallback;
    case ParameterKind::integer:
      return "whole number" + range + fallback;
    case ParameterKind::flag:
      return "true or false" + fallback;
    case ParameterKind::choice:
      return "one of " + joined(p.choices) + ", default " + std::get<std::string>(default_value) + also;
    case ParameterKind::text:
      return "text" + fallback;
    case ParameterKind::numbers:
      return std::to_string(p.count) + " numbers" + range + fallback;
  }
  return "";
}

const Parameter* ParameterSet::find(const std::string& name) const {
  for (const Parameter& p : parameters)
    if (p.name == name) return &p;
  return nullptr;
}

std::vector<std::string> ParameterSet::names() const {
  std::vector<std::string> names;
  for (const Parameter& p : parameters) names.push_back(p.name);
  return names;
}

}  // namespace trephine
