// SPDX-License-Identifier: GPL-3.0-or-later
#include "recipe_schema.h"

#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "stages/stage.h"

namespace trephine {
namespace {

using Json = nlohmann::ordered_json;

Json object(Json properties) {
  return {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
}

// `- name` or `- name: {parameters and ports}`
Json step_schema(const StageType& stage) {
  Json body = Json::parse(json_schema_of(stage.make_params()));
  body.erase("$schema");
  for (std::size_t i = 1; i < stage.ports.size(); ++i)
    body["properties"][stage.ports[i].name] = {{"type", "string"},
                                               {"description", stage.ports[i].help + ", as anatomy.stage"},
                                               {"pattern", "^[a-z0-9_]+\\.[a-z]+$"}};
  return {{"anyOf", {{{"const", stage.name}}, object({{stage.name, std::move(body)}})}},
          {"description", stage.summary}};
}

}  // namespace

std::string recipe_schema() {
  Json steps = Json::array();
  for (const StageType& stage : stage_types())
    if (stage.output != DataKind::nothing) steps.push_back(step_schema(stage));
  const Json share = {{"type", "number"}, {"minimum", 0}, {"maximum", 1}};
  Json anatomy = object({{"colour_rgb", {{"type", "array"}, {"items", share}, {"minItems", 3}, {"maxItems", 3}}},
                         {"opacity_ratio", share},
                         {"shows_face", {{"type", "boolean"}}},
                         {"stages", {{"type", "array"}, {"items", {{"anyOf", std::move(steps)}}}}}});
  anatomy["required"] = {"shows_face", "stages"};
  Json schema = object({{"trephine", {{"const", 1}}},
                        {"anatomies", {{"type", "object"}, {"additionalProperties", std::move(anatomy)}}}});
  schema["required"] = {"trephine", "anatomies"};
  Json out = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
              {"title", "A recipe of Trephine (pipelines/*.yaml)"}};
  out.update(schema);
  return out.dump(2) + "\n";
}

}  // namespace trephine
