// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "cli/declarations.h"

namespace trephine::cli {
namespace {

using Json = nlohmann::ordered_json;

// Escapes text for a cell of a Markdown table.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '<') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

std::string sentence(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text + ".";
}

// Who writes a file: a person may leave keys out and write values in more ways than one, a program does not.
enum class By { person, program };

std::string code(const std::string& text) { return "`" + text + "`"; }

std::string command_page(const Program& program, const Command& c) {
  std::string page = "# " + program.name + " " + c.name + "\n\n" + sentence(c.summary) + "\n\n```\n";
  const std::vector<std::string> parts = usage_of(program, c);
  for (std::size_t i = 0; i < parts.size(); ++i) page += (i == 0 ? "" : " \\\n    ") + parts[i];
  page += "\n```\n";
  if (!c.description.empty()) page += "\n" + c.description + "\n";
  if (!c.arguments.empty()) page += "\n## Arguments\n\n| Argument | Needed | Meaning |\n|---|---|---|\n";
  for (const Argument& a : c.arguments)
    page += "| " + cell(code(usage_of(a))) + " | " + (a.required ? "yes" : "no") + (a.repeated ? ", repeatable" : "") +
            " | " + cell(a.help) + " |\n";
  for (const ParameterGroup& g : all_groups(c)) {
    const AnyParams defaults = g.make();
    page += "\n## " + g.title + "\n\n| Parameter | Value | Meaning |\n|---|---|---|\n";
    for (const auto& [usage, d] : listed_of(defaults))
      page += "| " + cell(code(usage)) + " | " + cell(describe_parameter(*d.parameter, d.defaults.get())) + " | " +
              cell(d.parameter->help) + " |\n";
  }
  if (!c.examples.empty()) page += "\n## Examples\n\n```\n";
  for (const std::string& e : c.examples) page += e + "\n";
  if (!c.examples.empty()) page += "```\n";
  return page;
}

std::string index_page(const Program& program) {
  std::string page = "# " + program.name + "\n\n" + sentence(program.summary) + "\n\n";
  page += "The program wrote these pages (`" + program.name + " reference --out FOLDER`).\n";
  page += "A parameter has one name: `--max-gap-mm` on the command line is `max_gap_mm` in YAML and in manifests.\n\n";
  page += "| Command | Purpose |\n|---|---|\n";
  for (const Command& c : program.commands)
    if (!c.hidden) page += "| [" + c.name + "](" + page_of(c) + ".md) | " + cell(c.summary) + " |\n";
  page += "\nExit codes and the form of error messages are the same for all commands.\n";
  return page;
}

Json value_json(const ParameterValue& value) {
  return std::visit([](const auto& v) { return Json(v); }, value);
}

void add_range(Json& schema, const Range& range, bool integer) {
  const auto bound = [integer](double v) { return integer ? Json(static_cast<std::int64_t>(v)) : Json(v); };
  const double limit = integer ? 9e15 : std::numeric_limits<double>::max();
  if (range.min >= -limit) schema["minimum"] = bound(range.min);
  if (range.max <= limit) schema["maximum"] = bound(range.max);
}

void add_properties(Json& properties, const ParameterSet& set, const void* defaults, By by = By::person);

// The schema of an object with the set's keys, or of the value for which the struct stands.
Json schema_of(const ParameterSet& set, By by = By::person) {
  const std::shared_ptr<void> defaults = set.make();
  Json properties = Json::object(), required = Json::array();
  add_properties(properties, set, defaults.get(), by);
  if (set.only_value()) return properties[""];
  for (const Parameter& p : set.parameters)
    if (by == By::program ? !p.left_out : p.required) required.push_back(p.name);
  Json schema = {{"type", "object"}, {"properties", properties}};
  if (by == By::person) schema["additionalProperties"] = false;
  if (!required.empty()) schema["required"] = required;
  return schema;
}

// A key without a value, such as `skull:`, has the defaults, unless something must be said.
void allow_nothing(Json& schema, const ParameterSet& set) {
  if (!set.only_value() && !set.has_required()) schema["type"] = {"object", "null"};
}

// `- name` or `- name: {parameters}`.
Json step_schema(const StepChoice& step) {
  Json body = schema_of(*step.set);
  body["description"] = step.help;
  allow_nothing(body, *step.set);
  const Json object = {{"type", "object"},
                       {"properties", {{step.name, std::move(body)}}},
                       {"required", {step.name}},
                       {"additionalProperties", false}};
  if (step.set->has_required()) return object;
  return {{"anyOf", {{{"const", step.name}}, object}}, {"description", step.help}};
}

// Of a file that a program wrote, and a newer one may have written more.
Json written_schema(const Parameter& p) {
  Json s = Json::object();
  if (!p.help.empty()) s["description"] = p.help;
  if (p.kind == ParameterKind::text) {
    s["type"] = "string";
    if (p.form) s["pattern"] = p.form->pattern;
  } else if (p.kind == ParameterKind::any) {
    s["anyOf"] = {{{"type", "number"}},
                  {{"type", "boolean"}},
                  {{"type", "string"}},
                  {{"type", "array"}, {"items", {{"type", "number"}}}}};
  } else if (p.kind == ParameterKind::list) {
    s["type"] = "array";
    s["items"] = schema_of(p.item_set(), By::program);
  } else if (p.kind == ParameterKind::map) {
    s["type"] = "object";
    s["additionalProperties"] = schema_of(p.item_set(), By::program);
  } else if (p.kind == ParameterKind::group) {
    s.update(schema_of(p.item_set(), By::program));
  }
  return s;
}

Json parameter_schema(const Parameter& p, const void* object, By by) {
  Json s = by == By::program ? written_schema(p) : Json::object();
  if (s.contains("type") || s.contains("anyOf")) return s;
  if (by == By::person && !p.help.empty()) s["description"] = p.help;
  switch (p.kind) {
    case ParameterKind::number:
      s["type"] = "number";
      add_range(s, p.range, false);
      break;
    case ParameterKind::integer:
      s["type"] = "integer";
      add_range(s, p.range, true);
      break;
    case ParameterKind::flag:
      s["type"] = "boolean";
      break;
    case ParameterKind::text:
      if (p.source == "output") {
        s["type"] = "string";
        s["pattern"] = "^[a-z0-9_]+\\.[a-z0-9_]+$";
        return s;
      }
      s["type"] = {"string", "number", "boolean"};
      if (p.source == "value") s["type"].push_back("array");
      break;
    case ParameterKind::choice:
      s["type"] = "string";
      s["enum"] = p.choices;
      break;
    case ParameterKind::numbers: {
      Json item = {{"type", p.whole ? "integer" : "number"}};
      add_range(item, p.range, p.whole);
      s["type"] = "array";
      s["items"] = item;
      s["minItems"] = s["maxItems"] = p.count;
      break;
    }
    case ParameterKind::any:
      return s;
    case ParameterKind::group:
      s.update(schema_of(p.item_set()));
      return s;
    case ParameterKind::list: {
      s["type"] = "array";
      s["items"] = schema_of(p.item_set());
      if (p.count) s["maxItems"] = p.count;
      // A single value need not be written as a list.
      if (p.item_set().only_value()) return {{"description", p.help}, {"anyOf", {s["items"], s}}};
      return s;
    }
    case ParameterKind::map: {
      Json item = schema_of(p.item_set());
      allow_nothing(item, p.item_set());
      s["type"] = "object";
      s["additionalProperties"] = item;
      if (p.count) s["maxProperties"] = p.count;
      if (p.required) s["minProperties"] = 1;
      return s;
    }
    case ParameterKind::steps: {
      Json choices = Json::array();
      for (const StepChoice& step : p.steps) choices.push_back(step_schema(step));
      s["type"] = "array";
      s["items"] = {{"anyOf", choices}};
      if (p.required) s["minItems"] = 1;
      return s;
    }
  }
  if (by == By::program) return s;
  if (p.zero_is_none) s["minimum"] = 0;
  const ParameterValue value = p.get(object);
  const bool none = p.kind == ParameterKind::choice && std::get<std::string>(value).empty();
  if (!p.required && !none) s["default"] = value_json(value);
  return s;
}

void add_properties(Json& properties, const ParameterSet& set, const void* defaults, By by) {
  for (const Parameter& p : set.parameters) properties[p.name] = parameter_schema(p, defaults, by);
}

// The schema of every command's parameters, each as an object under $defs.
std::string schema_page(const Program& program) {
  Json root = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
               {"title", "Parameters of " + program.name},
               {"$defs", Json::object()}};
  for (const Command& c : program.commands) {
    if (c.hidden || c.groups.empty()) continue;
    Json properties = Json::object();
    for (const ParameterGroup& g : c.groups) {
      const AnyParams defaults = g.make();
      add_properties(properties, *defaults.set, defaults.object.get());
    }
    root["$defs"][page_of(c)] = {
        {"description", c.summary}, {"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
  }
  return root.dump(2) + "\n";
}

}  // namespace

std::string json_schema_of(const AnyParams& defaults, int indent) { return schema_of(*defaults.set).dump(indent); }

std::string json_schema_of_written(const ParameterSet& set) { return schema_of(set, By::program).dump(); }

std::vector<std::pair<std::string, std::string>> reference_pages(const Program& program) {
  check_declarations(program);
  std::vector<std::pair<std::string, std::string>> pages = {{"index.md", index_page(program)},
                                                            {"parameters.schema.json", schema_page(program)}};
  for (const Command& c : program.commands)
    if (!c.hidden) pages.emplace_back(page_of(c) + ".md", command_page(program, c));
  if (program.more_reference_pages)
    for (auto& page : program.more_reference_pages()) pages.push_back(std::move(page));
  return pages;
}

}  // namespace trephine::cli
