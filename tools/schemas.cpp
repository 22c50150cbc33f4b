// SPDX-License-Identifier: GPL-3.0-or-later
#include "schemas.h"

#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "config/case_file.h"
#include "config/recipe_file.h"
#include "config/scene_file.h"
#include "library/library_config.h"
#include "stages/stage.h"
#include "trade/plan.h"

namespace trephine {
namespace {

using Json = nlohmann::ordered_json;

std::string page(const std::string& title, const Json& schema) {
  Json out = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  out.update(schema);
  return out.dump(2) + "\n";
}

template <class P>
Json schema_of() {
  return Json::parse(json_schema_of(AnyParams::make<P>()));
}

// Parameters and ports of a stage as a recipe writes them.
Json body_schema(const StageType& stage, bool first_port) {
  Json body = Json::parse(json_schema_of(stage.make_params()));
  for (std::size_t i = first_port ? 0 : 1; i < stage.ports.size(); ++i)
    if (!first_port || stage.ports[i].kind == DataKind::field)
      body["properties"][stage.ports[i].name] = {{"type", "string"},
                                                 {"description", stage.ports[i].help + ", as anatomy.stage"},
                                                 {"pattern", "^[a-z0-9_]+\\.[a-z_]+$"}};
  body["description"] = stage.summary;
  return body;
}

// Schema of a step: `- name` or `- name: {parameters and ports}`.
Json step_schema(const StageType& stage) {
  Json body = body_schema(stage, false);
  body["type"] = {"object", "null"};
  const Json object = {{"type", "object"},
                       {"properties", {{stage.name, std::move(body)}}},
                       {"required", {stage.name}},
                       {"additionalProperties", false}};
  return {{"anyOf", {{{"const", stage.name}}, object}}, {"description", stage.summary}};
}

Json recipe_schema() {
  Json steps = Json::array();
  for (const StageType* stage : stages_of(StagePlace::anatomy)) steps.push_back(step_schema(*stage));
  Json anatomy = schema_of<RecipeAnatomyParams>();
  anatomy["properties"]["stages"] = {{"type", "array"}, {"items", {{"anyOf", std::move(steps)}}}};
  anatomy["required"].push_back("stages");
  Json schema = schema_of<RecipeFileParams>();
  schema["properties"]["anatomies"] = {{"type", "object"}, {"additionalProperties", std::move(anatomy)}};
  schema["required"].push_back("anatomies");
  for (const StageType* stage : stages_of(StagePlace::scan))
    schema["properties"][stage->name] = body_schema(*stage, true);
  return schema;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> file_schemas() {
  return {
      {"recipe.schema.json", page("A recipe of Trephine (pipelines/*.yaml)", recipe_schema())},
      {"scene.schema.json", page("A scene of Trephine (configs/scenes/*.yaml)", schema_of<SceneFileParams>())},
      {"configuration.schema.json", page("The configuration of a case (configs/*.yaml)", schema_of<CaseFileParams>())},
      {"materials.schema.json", page("Materials (configs/materials.yaml)", schema_of<MaterialsFileParams>())},
      {"library.schema.json",
       page("A library of Trephine (LIBRARY.yaml)", Json::parse(json_schema_of(library_file_params())))},
      {"trade.schema.json",
       page("The plan of a sweep (configs/trade/*.yaml)", Json::parse(json_schema_of(trade_file_params())))}};
}

}  // namespace trephine
