// SPDX-License-Identifier: GPL-3.0-or-later
// Edits of a shape that are no painting: snakes that are watched while they grow, cuts, smoothing.
#include "config/corrected_field.h"
#include "desk/desk_state.h"
#include "desk/json_reply.h"
#include "desk/patches.h"
#include "json/declared_json.h"

namespace trephine::desk {
namespace {

/// {"snake": {...}}, as a list of one.
segmentation::EditList edits_of(const nlohmann::json& edit) {
  if (edit.is_object() && edit.contains("patch"))
    throw Error(ExitCode::usage, "", "edit", "a patch is sent as what was painted");
  segmentation::EditList list;
  const nlohmann::json text = {{"trephine_edits", 1}, {"edits", nlohmann::json::array({edit})}};
  json::read_declared_json(text.dump(), parameters_of<segmentation::EditList>(), &list);
  return list;
}

Reply snake(DeskState& desk, const Request& request) {
  const auto json = desk::json_of(request);
  if (json.contains("forget")) {
    desk.live.forget();
    return json_reply({{"done", true}});
  }
  const std::string token = json.at("case");
  const auto one = desk.cases.looked_at(token);
  const segmentation::EditList list = edits_of({{"snake", json.at("snake")}});
  const LiveEdit::Now now =
      desk.live.snake(token, *one, list.edits[0].second.as<segmentation::SnakeEdit>(), json.at("steps").get<int>());
  return json_reply({{"steps", now.steps}, {"change_mm", now.change_mm}, {"volume_ml", now.volume_ml}});
}

Reply try_edit(DeskState& desk, const Request& request) {
  const auto json = desk::json_of(request);
  const std::string token = json.at("case");
  const auto one = desk.cases.looked_at(token);
  const auto made = desk.live.preview(token, *one, json.at("anatomy"), edits_of(json.at("edit")));
  Json out = {{"warnings", Json::array()}};
  for (const Warning& w : made.warnings) out["warnings"].push_back(to_text(w));
  for (const auto& [name, value] : figures_of(made.result))
    out[name] = std::visit([](const auto& v) { return Json(v); }, value);
  return json_reply(out);
}

Reply edit(DeskState& desk, const Request& request) {
  const auto json = desk::json_of(request);
  const std::string token = json.at("case"), anatomy = json.at("anatomy");
  const auto one = desk.cases.looked_at(token);
  const auto config = one->config();
  if (!config || config::corrected_field(*config, anatomy).empty())
    throw Error(ExitCode::usage, "", "anatomy", "has no field that could be corrected");
  require_open(*one, anatomy);
  const int id =
      save_edit(desk.library, token, anatomy, edits_of(json.at("edit")),
                {json.at("by").get<std::string>(), json.value("why", ""), json.at("base").get<std::string>()});
  desk.live.forget();
  return json_reply({{"done", anatomy}, {"id", id}});
}

}  // namespace

Routes edit_routes() {
  return {
      {"api/snake", {"POST", snake}},
      {"api/try_edit", {"POST", try_edit}},
      {"api/edit", {"POST", edit}},
  };
}

}  // namespace trephine::desk
