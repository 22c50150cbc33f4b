// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/slicer_module.h"

#include <algorithm>
#include <cmath>

#include "base/html_text.h"
#include "base/joined.h"
#include "base/text.h"
#include "cli/declarations.h"

namespace trephine::cli {
namespace {

constexpr const char* unset = "unset";  ///< among the choices of what need not be given

std::string element(const std::string& name, const std::string& text) {
  return "      <" + name + ">" + html_text(text) + "</" + name + ">\n";
}

std::string words_of(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

// Slicer takes letters, digits and underscores alone.
std::string long_flag(const std::string& name) { return element("longflag", "--" + name); }

// What every parameter has; `place` is its flag or its index.
std::string described(const std::string& name, const std::string& place, const std::string& help) {
  return element("name", name) + place + element("description", help) + element("label", words_of(name));
}

std::string whole(const std::string& tag, const std::string& inner) {
  return "    <" + tag + ">\n" + inner + "    </" + tag + ">\n";
}

std::string choice_xml(std::string inner, std::vector<std::string> choices, std::string first) {
  if (first.empty()) choices.insert(choices.begin(), first = unset);
  inner += element("default", first);
  for (const std::string& c : choices) inner += element("element", c);
  return whole("string-enumeration", inner);
}

bool is_output(Argument::Kind kind) { return kind == Argument::Kind::out_file || kind == Argument::Kind::out_folder; }

std::string argument_xml(const Argument& a, int& index) {
  const std::string place = a.positional ? element("index", std::to_string(index++)) : long_flag(a.name);
  std::string inner = described(a.name, place, a.help);
  switch (a.kind) {
    case Argument::Kind::text:
      return whole("string", inner);
    case Argument::Kind::choice:
      return choice_xml(inner, a.choices, a.required ? a.choices.front() : "");
    case Argument::Kind::in_file:
    case Argument::Kind::out_file:
      return whole("file", inner + element("channel", is_output(a.kind) ? "output" : "input"));
    case Argument::Kind::in_folder:
    case Argument::Kind::in_path:
    case Argument::Kind::in_scan:
    case Argument::Kind::out_folder:
      break;
  }
  return whole("directory", inner + element("channel", is_output(a.kind) ? "output" : "input"));
}

// A power of ten: a hundredth of the range or less, and so small that the default is a multiple of it, for Slicer
// rounds to the step's digits.
double step_of(const Parameter& p, double least, double value) {
  if (p.kind == ParameterKind::integer) return 1;
  double step = std::pow(10, std::floor(std::log10(std::max(1e-6, (p.range.max - least) / 100))));
  while (step > 1e-9 && std::abs(value / step - std::round(value / step)) > 1e-6) step /= 10;
  return step;
}

std::string constraints(const Parameter& p, double value) {
  if (!std::isfinite(p.range.min) || !std::isfinite(p.range.max)) return "";
  const double least = p.zero_is_none ? std::min(0.0, p.range.min) : p.range.min;
  return "      <constraints>\n  " + element("minimum", to_text(least)) + "  " +
         element("maximum", to_text(p.range.max)) + "  " + element("step", to_text(step_of(p, least, value))) +
         "      </constraints>\n";
}

// A list with commas, as flags take it: "0.8,0.8,0.8".
std::string plain(const ParameterValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  const auto* numbers = std::get_if<std::vector<double>>(&value);
  if (!numbers) return to_text(value);
  return joined(*numbers, ",", [](const double n) { return to_text(n); });
}

std::string parameter_xml(const Parameter& p, const void* object) {
  std::string inner = described(p.name, long_flag(p.name), p.help);
  if (!p.is_value()) return whole("string", inner);
  const ParameterValue value = p.get(object);
  switch (p.kind) {
    case ParameterKind::flag: {
      if (!std::get<bool>(value)) return whole("boolean", inner + element("default", "false"));
      const std::string off = "no_" + p.name;
      return whole("boolean", described(off, long_flag(off), "Not so: " + p.help) + element("default", "false"));
    }
    case ParameterKind::number:
      return whole("double", inner + element("default", plain(value)) + constraints(p, std::get<double>(value)));
    case ParameterKind::integer:
      return whole("integer", inner + element("default", plain(value)) + constraints(p, 0));
    case ParameterKind::numbers:
      return whole(p.whole ? "integer-vector" : "double-vector", inner + element("default", plain(value)));
    case ParameterKind::choice:
      return choice_xml(inner, p.choices, plain(value));
    default:
      return whole("string", inner + element("default", plain(value)));
  }
}

std::string group_xml(const std::string& label, const std::string& help, const std::string& inner, bool advanced) {
  if (inner.empty()) return "";
  return std::string("  <parameters") + (advanced ? " advanced=\"true\"" : "") + ">\n" + "    <label>" +
         html_text(label) + "</label>\n    <description>" + html_text(help) + "</description>\n" + inner +
         "  </parameters>\n";
}

const Argument* find_argument(const Command& command, const std::string& flag) {
  for (const Argument& a : command.arguments)
    if (!a.positional && flag_of(a.name) == flag) return &a;
  return nullptr;
}

// Whether the word says what is so anyway.
bool says_default(const Command& command, const std::string& flag, const std::string& word) {
  if (word.empty()) return true;
  if (const Argument* a = find_argument(command, flag))
    return a->kind == Argument::Kind::choice && !a->required && word == unset;
  for (const ParameterGroup& g : all_groups(command)) {
    const AnyParams defaults = g.make();
    for (const Parameter& p : defaults.set->parameters) {
      if (flag_of(p.name) != flag || !p.is_value()) continue;
      if (p.kind == ParameterKind::choice && word == unset) return plain(defaults.get(p)).empty();
      ParameterValue value;
      const auto items = p.kind == ParameterKind::numbers ? split_at(word, ',') : std::vector<std::string>{word};
      return word == plain(defaults.get(p)) || (parse_parameter(p, items, value).empty() && value == defaults.get(p));
    }
  }
  return false;
}

}  // namespace

std::string slicer_module_xml(const Program& program, const Command& command) {
  std::string out = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<executable>\n";
  const auto head = [&](const char* name, const std::string& text) {
    out += "  <" + std::string(name) + ">" + html_text(text) + "</" + name + ">\n";
  };
  head("category", "Trephine");
  head("title", program.name + " " + command.name);
  head("description", command.description);
  head("version", program.version);
  head("documentation-url", "");
  head("license", "GPL-3.0-or-later");
  head("contributor", "the authors of Trephine");
  int index = 0;
  std::string arguments;
  for (const Argument& a : command.arguments) arguments += argument_xml(a, index);
  out += group_xml("Input and output", "What is read and written", arguments, false);
  for (const ParameterGroup& g : all_groups(command)) {
    const AnyParams defaults = g.make();
    std::string inner;
    for (const Parameter& p : defaults.set->parameters) inner += parameter_xml(p, defaults.object.get());
    out += group_xml(g.title, g.title, inner, g.title == common_title);
  }
  return out + "</executable>\n";
}

std::vector<std::string> words_of_slicer(const Command& command, const std::vector<std::string>& words) {
  std::set<std::string> valued{"--returnparameterfile", "--processinformationaddress"};
  for (const Argument& a : command.arguments)
    if (!a.positional) valued.insert(flag_of(a.name));
  for (const ParameterGroup& g : all_groups(command))
    for (const Parameter& p : g.make().set->parameters)
      if (p.kind != ParameterKind::flag) valued.insert(flag_of(p.name));
  std::vector<std::string> kept;
  for (std::size_t n = 0; n < words.size(); ++n) {
    const std::string flag = words[n].rfind("--", 0) == 0 ? flag_of(words[n].substr(2)) : words[n];
    if (valued.count(flag) == 0 || n + 1 == words.size()) {
      kept.push_back(flag);
      continue;
    }
    const std::string& word = words[++n];
    if (flag == "--returnparameterfile" || flag == "--processinformationaddress") continue;
    if (!says_default(command, flag, word)) kept.insert(kept.end(), {flag, word});
  }
  return kept;
}

}  // namespace trephine::cli
