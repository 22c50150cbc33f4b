// SPDX-License-Identifier: GPL-3.0-or-later
#include "schemas.h"

#include <nlohmann/json.hpp>

#include "cases/case.h"
#include "cli/command.h"
#include "config/case_file.h"
#include "config/recipe_file.h"
#include "config/scene_file.h"
#include "lessons/rubric_types.h"
#include "library/library_config.h"
#include "rubric_file.h"
#include "trade/plan.h"

namespace trephine::tools {
namespace {

using Json = nlohmann::ordered_json;

std::string page(const std::string& title, const Json& schema) {
  Json out = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  out.update(schema);
  return out.dump(2) + "\n";
}

template <class P>
Json schema_of() {
  return Json::parse(cli::json_schema_of(AnyParams::make<P>()));
}

// One row of a Markdown table for each key.
std::string keys_table(const std::string& prefix, const AnyParams& defaults) {
  std::string rows;
  for (const DeclaredParameter& d : declared_of(defaults)) {
    std::string help = d.parameter->help;
    for (std::size_t at = 0; (at = help.find_first_of("|<", at)) != std::string::npos; at += 2) help.insert(at, "\\");
    rows +=
        "| `" + prefix + d.path + "` | " + describe_parameter(*d.parameter, d.defaults.get()) + " | " + help + " |\n";
  }
  return rows;
}

// Of a file that the program writes: no defaults, but what may be missing.
std::string written_table(const ParameterSet& set, const std::string& prefix) {
  std::string rows;
  for (const Parameter& p : set.parameters) {
    const std::string path = prefix + p.name;
    const std::shared_ptr<void> defaults = set.make();
    const std::string value = describe_parameter(p, defaults.get());
    rows += "| `" + path + "` | " + value.substr(0, std::min(value.find(", default"), value.find(", required"))) +
            (p.left_out ? ", may be missing" : "") + " | " + p.help + " |\n";
    if (p.item_set && !p.item_set().only_value())
      rows += written_table(p.item_set(), path + (p.kind == ParameterKind::list ? "[]." : "."));
  }
  return rows;
}

std::string case_page() {
  return "# case.json\n\nEvery key of `case.json` in format " + cases::case_version() +
         ", from the declarations in the program. `[]` stands for each item of a list. [The case "
         "package](../case-package.md) says how the file is read and what the other files of a "
         "case hold.\n\n| Key | Value | Meaning |\n|---|---|---|\n"
         "| `format` | text | `trephine-case " +
         cases::case_version() + "`, the first key of the file. |\n" +
         written_table(parameters_of<cases::CaseManifest>(), "") +
         "| `checksum` | text | SHA-256 of all bytes before its comma, the last key of the file. |\n";
}

Json case_schema() {
  Json body = Json::parse(cli::json_schema_of_written(parameters_of<cases::CaseManifest>()));
  body["properties"]["format"] = {
      {"type", "string"}, {"pattern", "^trephine-case " + std::to_string(cases::case_version_major) + "\\.[0-9]+$"}};
  body["properties"]["checksum"] = {{"type", "string"}, {"pattern", cases::case_form::sha256.pattern}};
  body["required"].push_back("format");
  body["required"].push_back("checksum");
  return body;
}

// A rubric is read by what its module declares.
template <class Section>
std::string rubric_sections(const Section& section) {
  std::string text;
  for (const lesson::RubricType& t : lessons::rubric_types())
    text += section("A rubric of the lesson " + t.module + " (configs/rubrics/\\*.yaml)", rubric_file_params(t));
  return text;
}
Json rubric_schema() {
  Json all = Json::array();
  for (const lesson::RubricType& t : lessons::rubric_types())
    all.push_back(Json::parse(cli::json_schema_of(rubric_file_params(t))));
  return all.size() == 1 ? all[0] : Json{{"oneOf", all}};
}

// The keys of all files, for a reader; the schemas are for editors.
std::string keys_page() {
  const std::string head = "| Key | Value | Meaning |\n|---|---|---|\n";
  const auto section = [&](const std::string& title, const AnyParams& defaults) {
    return "\n## " + title + "\n\n" + head + keys_table("", defaults);
  };
  return "# Files\n\nEvery key of the files that Trephine reads, from the declarations in the program. NAME stands for "
         "a name that the file gives, a number for an item of a list. "
         "How the "
         "files "
         "work together is explained in [configurations](../configurations.md).\n" +
         section("A case (configs/\\*.yaml)", AnyParams::make<config::CaseFileParams>()) +
         section("A scene (configs/scenes/\\*.yaml)", AnyParams::make<config::SceneFileParams>()) +
         "\n## A recipe (pipelines/\\*.yaml)\n\n"
         "`anatomies.NAME.stages` lists the stages that make the anatomy; the page of each stage lists its "
         "parameters.\n\n" +
         head + keys_table("", AnyParams::make<config::RecipeFileParams>()) +
         section("Materials (configs/materials.yaml)", AnyParams::make<config::MaterialsFileParams>()) +
         section("A library (LIBRARY.yaml)", library::library_file_params()) +
         section("The plan of a sweep (configs/trade/\\*.yaml)", trade::trade_file_params()) + rubric_sections(section);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> file_schemas() {
  return {
      {"files.md", keys_page()},
      {"case.md", case_page()},
      {"case.schema.json", page("case.json of a Trephine case, version " + cases::case_version(), case_schema())},
      {"recipe.schema.json", page("A recipe of Trephine (pipelines/*.yaml)", schema_of<config::RecipeFileParams>())},
      {"scene.schema.json", page("A scene of Trephine (configs/scenes/*.yaml)", schema_of<config::SceneFileParams>())},
      {"configuration.schema.json",
       page("The configuration of a case (configs/*.yaml)", schema_of<config::CaseFileParams>())},
      {"materials.schema.json", page("Materials (configs/materials.yaml)", schema_of<config::MaterialsFileParams>())},
      {"library.schema.json",
       page("A library of Trephine (LIBRARY.yaml)", Json::parse(cli::json_schema_of(library::library_file_params())))},
      {"trade.schema.json", page("The plan of a sweep (configs/trade/*.yaml)",
                                 Json::parse(cli::json_schema_of(trade::trade_file_params())))},
      {"rubric.schema.json", page("A rubric of Trephine (configs/rubrics/*.yaml)", rubric_schema())}};
}

}  // namespace trephine::tools
