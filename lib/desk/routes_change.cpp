// SPDX-License-Identifier: GPL-3.0-or-later
// What a person changes of a case, and what is known of it.
#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"
#include "base/write_file.h"
#include "config/corrected_field.h"
#include "config/yaml_document.h"
#include "desk/desk_state.h"
#include "desk/hand_work.h"
#include "desk/patches.h"
#include "desk/scenes.h"
#include "library/catalogue.h"

namespace trephine::desk {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t max_draft_bytes = 1u << 28;

Json json_of(Vec3 v) { return Json::array({v.x, v.y, v.z}); }

Json json_of(const HandEntry& e) {
  Json out = {{"id", e.id}, {"when", e.when}, {"by", e.by}, {"why", e.why}, {"kind", e.kind}, {"what", e.what}};
  if (e.is_correction()) {
    out["anatomy"] = e.anatomy;
    out["on"] = e.on;
    if (!e.file.empty()) out["file"] = e.file;
    if (!e.edit.empty()) out["edit"] = Json::parse(e.edit);
  }
  return out;
}

/// What the case holds now, as it was built last.
Json json_of(const cases::CaseManifest& m) {
  Json out = {
      {"landmarks", Json::array()}, {"targets", Json::array()}, {"holes", Json::array()}, {"figures", Json::object()}};
  for (const cases::CaseLandmark& l : m.landmarks)
    out["landmarks"].push_back({{"name", l.name},
                                {"position_mm", json_of(l.position_mm)},
                                {"confidence", l.confidence},
                                {"source", l.source}});
  for (const cases::CaseTarget& t : m.targets)
    out["targets"].push_back({{"name", t.name}, {"position_mm", json_of(t.position_mm)}, {"confidence", t.confidence}});
  for (const cases::CaseBurrHole& h : m.burr_holes)
    out["holes"].push_back({{"name", h.name},
                            {"position_mm", json_of(h.position_mm)},
                            {"direction", json_of(h.direction)},
                            {"diameter_mm", h.diameter_mm}});
  out["findings"] = Json::array();
  for (const cases::CaseFinding& f : m.findings)
    out["findings"].push_back(
        {{"text", f.text}, {"position_mm", json_of(f.position_mm)}, {"confidence", f.confidence}});
  for (const auto& [name, value] : m.figures)
    out["figures"][name] = std::visit([](const auto& v) { return Json(v); }, value);
  return out;
}

Json json_of(const config::CaseConfig& config) {
  Json out = {{"landmarks", Json::object()}, {"holes", Json::array()},           {"values", Json::array()},
              {"anatomies", Json::array()},  {"known_landmarks", Json::array()}, {"face", config.face},
              {"steps", Json::array()}};
  out["cuts_holes"] = !config.drilled.empty();
  for (const cases::CaseLandmark& l : config.landmarks) out["landmarks"][l.name] = json_of(l.position_mm);
  for (const config::CaseDrill& h : config.burr_holes) {
    const auto& p = h.params.as<boolean::BurrHoleParams>();
    out["holes"].push_back({{"name", h.name},
                            {"at", p.at == boolean::BurrHoleRequest::At::kocher ? "kocher" : "position"},
                            {"side", p.side == boolean::BurrHoleRequest::Side::right ? "right" : "left"},
                            {"diameter_mm", p.diameter_mm},
                            {"position_mm", p.position_mm},
                            {"direction", p.direction},
                            {"toward", p.toward}});
  }
  for (const auto& [path, value, origin, about] : config.values)
    out["values"].push_back(
        {{"path", path}, {"value", value}, {"source", config::to_text(origin.source)}, {"about", about}});
  for (const config::RecipeAnatomy& a : config.anatomies)
    out["anatomies"].push_back({{"name", a.name},
                                {"colour_rgb", a.colour_rgb},
                                {"shown", config.is_shown(a.name)},
                                {"field", config::corrected_field(config, a.name)}});
  // The steps whose fields can be drawn on the scan's voxels.
  for (const config::RecipeAnatomy& a : config.anatomies)
    for (const config::RecipeStep& step : a.steps)
      if (step.type->can_be_corrected()) out["steps"].push_back(a.name + "." + step.type->name);
  if (const config::RecipeStep* step = config.landmarks_step())
    for (const stages::StagePoint& point : step->type->points) out["known_landmarks"].push_back(point.name);
  return out;
}

/// What a file says, as it says it: a list or map of numbers and texts.
Json json_of(const config::YamlNode& node) {
  if (node.kind == config::YamlNode::Kind::list) {
    Json out = Json::array();
    for (const config::YamlNode& item : node.items) out.push_back(json_of(item));
    return out;
  }
  if (node.kind == config::YamlNode::Kind::map) {
    Json out = Json::object();
    for (const auto& [key, value] : node.entries) out[key.text] = json_of(value);
    return out;
  }
  if (node.kind == config::YamlNode::Kind::null) return nullptr;
  if (const auto number = parse_number(node.text); number && !node.quoted) return *number;
  return node.text;
}

Said said_of(const nlohmann::json& json) {
  return {json.at("by").get<std::string>(), json.value("why", ""), json.at("base").get<std::string>()};
}

fs::path draft_file(const DeskLibrary& library, const Request& request) {
  const std::string what = request.value("what");
  if (what != "paint" && what != "view") throw Error(ExitCode::usage, "", "what", "must be paint or view");
  if (request.value("case").empty()) throw Error(ExitCode::usage, "", "case", "is needed");
  return library.options().library / ".library" / "desk" / (request.value("case") + "." + what);
}

void save(DeskLibrary& library, const std::string& token, const HandChange& change) {
  const DeskLock lock(library);
  const DeskCase one = library.find(token);
  std::vector<HandEntry> journal = read_journal(one);
  save_change(library, one, change, journal);
}

std::string value_of(const config::CaseConfig& config, const std::string& path) {
  for (const config::ValueRow& row : config.values)
    if (row.path == path) return row.value;
  return "";
}

config::YamlChange holes_line(const nlohmann::json& holes) {
  if (!holes.is_array()) throw Error(ExitCode::usage, "", "holes", "must be a list");
  return {{"burr_holes"},
          yaml_of_json(holes)};  // an empty list says that none is meant, which a scene that cuts asks for
}

/// For the history: "2 burr holes: Kocher's point on the right, 14 mm; 31.2, -12.0, 80.4 mm (LPS), 11 mm".
std::string in_words(const nlohmann::json& holes) {
  if (holes.empty()) return "no burr hole";
  std::string out = fmt::format("{} burr hole{}: ", holes.size(), holes.size() == 1 ? "" : "s");
  for (std::size_t i = 0; i < holes.size(); ++i) {
    const auto& hole = holes[i];
    // What a file says may be anything until it was read as a configuration, which comes next and explains it.
    if (!hole.is_object()) return "burr holes";
    const auto said = [&](const char* key, double usual) {
      const auto found = hole.find(key);
      return found != hole.end() && found->is_number() ? found->get<double>() : usual;
    };
    out += i ? "; " : "";
    const auto place = hole.find("position_mm");
    const bool by_place = place != hole.end() && place->is_array() && place->size() == 3 &&
                          std::all_of(place->begin(), place->end(), [](const auto& v) { return v.is_number(); });
    out += by_place ? fmt::format("{:.1f}, {:.1f}, {:.1f} mm (LPS)", (*place)[0].template get<double>(),
                                  (*place)[1].template get<double>(), (*place)[2].template get<double>())
                    : fmt::format("Kocher's point on the {}", hole.value("side", "right") == "left" ? "left" : "right");
    out += fmt::format(", {:g} mm", said("diameter_mm", boolean::BurrHoleParams().diameter_mm));
  }
  return out;
}

void check_holes_count(const config::CaseConfig& now, std::size_t count) {
  if (now.burr_holes.size() != count)
    throw Error(ExitCode::usage, "", "burr_holes",
                "have no effect: the scene cuts none (`burr_holes` of its anatomies)");
}

/// One value, or several that mean something together alone, as the corners of a box.
nlohmann::json values_of(const nlohmann::json& json) {
  if (!json.contains("values")) return nlohmann::json::array({json});
  const auto& all = json.at("values");
  if (!all.is_array() || all.empty() || all.size() > 16)
    throw Error(ExitCode::usage, "", "values", "must be a list of 1 to 16");
  return all;
}

config::YamlChange value_line(const std::string& path, const nlohmann::json& value) {
  if (value.is_null()) return {{"set", path}, {}};
  const std::string text = value;
  // A list or a number stays what it is; anything else is a text.
  const bool is_list = text.size() > 1 && text.front() == '[' && text.back() == ']' &&
                       text.find_first_not_of("[]0123456789+-.eE, ") == std::string::npos;
  return {{"set", path}, is_list || parse_number(text) ? text : config::yaml_scalar(text)};
}

Reply case_info(DeskState& desk, const Request& request) {
  const std::string token = request.value("case");
  Json out = {{"case", token}};
  const fs::path folder = desk.library.options().library / token;
  std::error_code ignored;
  if (fs::exists(folder / "case.json", ignored)) {
    const library::CaseRow row = library::read_library_case(desk.library.options().library, token);
    out["fault"] = row.fault;
    out["warnings"] = row.warnings;
    out["text"] = row.fault.empty() ? library::case_text(row) : "";
    if (row.fault.empty()) out["built"] = json_of(row.manifest);
  }
  if (desk.library.options().config.empty()) return json_reply(out);
  const DeskCase one = desk.library.find(token);
  out["config"] = one.config.filename().string();
  out["shared"] = !one.copied_from.empty();
  out["fixed"] = one.fixed;
  out["reasons"] = one.reasons;
  out["base"] = config_sha256(one);
  const std::vector<char> text = read_file(one.text_file(), 1 << 20);
  out["yaml"] = std::string(text.begin(), text.end());
  out["journal"] = Json::array();
  for (const HandEntry& e : read_journal(one)) out["journal"].push_back(json_of(e));
  out["now"] = json_of(config::read_case_config(one.text_file(), desk.library.overrides_of(one)));
  const config::YamlNode file = config::read_yaml(one.text_file());
  const config::YamlNode* said = file.find("burr_holes");
  out["now"]["scenes"] = scenes_of(desk.library, one);
  out["now"]["said_holes"] = said ? json_of(*said) : Json::array();
  return json_reply(out);
}

Reply landmark(DeskState& desk, const Request& request) {
  const auto json = desk::json_of(request);
  const std::string name = json.at("name");
  HandChange change = change_of(json);
  change.kind = "landmark";
  Json warnings = Json::array();
  if (json.at("position_mm").is_null()) {
    change.changes = {{{"landmarks", name}, {}}};
    change.what = name + ": as it is found";
  } else {
    const auto at = json.at("position_mm").get<std::array<double, 3>>();
    // A tenth of a micrometre: more digits than a mouse can mean would only fill the line.
    std::vector<double> rounded;
    for (const double v : at) rounded.push_back(std::round(v * 1e4) / 1e4);
    const std::string value = config::yaml_list(rounded);
    for (const Warning& w :
         desk.cases.doubts_of(json.at("case"), {name, {rounded[0], rounded[1], rounded[2]}, 1, "given"}))
      warnings.push_back(to_text(w));
    change.changes = {{{"landmarks", name}, value}};
    change.what = name + ": " + value;
    change.check = [name, rounded](const config::CaseConfig& now) {
      const auto given = now.landmark_positions_mm();
      const auto found = given.find(name);
      if (found == given.end() || norm(found->second - Vec3{rounded[0], rounded[1], rounded[2]}) > 1e-6)
        throw Error(ExitCode::usage, "", "landmarks." + name,
                    "has no effect: a file of landmarks that the case names says otherwise");
    };
  }
  save(desk.library, json.at("case"), change);
  return json_reply({{"done", change.what}, {"warnings", warnings}});
}

Reply holes(DeskState& desk, const Request& request) {
  const auto json = desk::json_of(request);
  HandChange change = change_of(json);
  change.kind = "burr_holes";
  const auto& holes = json.at("holes");
  change.changes = {holes_line(holes)};
  change.what = in_words(holes);
  change.check = [count = holes.size()](const config::CaseConfig& now) { check_holes_count(now, count); };
  save(desk.library, json.at("case"), change);
  return json_reply({{"done", change.what}});
}

Reply value(DeskState& desk, const Request& request) {
  const auto json = desk::json_of(request);
  const std::string token = json.at("case");
  HandChange change = change_of(json);
  change.kind = "value";
  const nlohmann::json all = values_of(json);
  const DeskCase one = desk.library.find(token);
  const config::CaseConfig before = config::read_case_config(one.text_file(), desk.library.overrides_of(one));
  struct Wanted {
    std::string path, was, text;
  };
  std::vector<Wanted> wanted;
  for (const auto& item : all) {
    const std::string path = item.at("path");
    change.changes.push_back(value_line(path, item.at("value")));
    change.what += change.what.empty() ? "" : "; ";
    if (item.at("value").is_null()) {
      change.what += path + ": as the recipe says";
    } else {
      wanted.push_back({path, value_of(before, path), item.at("value")});
      change.what += path + ": " + wanted.back().text;
    }
  }
  change.check = [wanted](const config::CaseConfig& now) {
    for (const Wanted& w : wanted)
      if (value_of(now, w.path) == w.was && w.was != w.text)
        throw Error(ExitCode::usage, "", w.path,
                    "has no effect: what LIBRARY.yaml or the scene says of it is stronger");
  };
  save(desk.library, token, change);
  return json_reply({{"done", change.what}});
}

// What would come of a value or of burr holes, before they are saved. One at a time: a newer one ends the one before.
Reply try_change(DeskState& desk, const Request& request) {
  const auto json = desk::json_of(request);
  const std::string token = json.at("case");
  const std::shared_ptr<OpenCase> looked_at = desk.cases.looked_at(token);
  TrialWish wish;
  if (json.contains("holes")) {
    wish.changes.push_back(holes_line(json.at("holes")));
    wish.hole = json.at("hole").get<std::size_t>();
  } else if (json.contains("step")) {
    wish.step = json.at("step");
  } else {
    for (const auto& item : values_of(json)) wish.changes.push_back(value_line(item.at("path"), item.at("value")));
    wish.anatomy = json.at("anatomy");
  }
  desk.trials.start(desk.library, token, looked_at, std::move(wish));
  return json_reply({{"started", true}});
}

Reply tried(DeskState& desk, const Request& request) {
  const std::shared_ptr<Trial> trial = desk.trials.of(request.value("case"));
  const Trial::Now now = trial->now();
  Json out = {{"running", now.running}, {"doing", now.doing},         {"fraction", now.fraction},
              {"fault", now.fault},     {"has_field", now.has_field}, {"reports", Json::array()}};
  if (now.volumes_ml) out["volume_ml"] = {{"now", now.volumes_ml->first}, {"then", now.volumes_ml->second}};
  for (const auto& [node, report] : now.reports) {
    Json figures = Json::object();
    for (const auto& [name, value] : report.figures)
      figures[name] = std::visit([](const auto& v) { return Json(v); }, value);
    out["reports"].push_back({{"name", node}, {"figures", figures}, {"warnings", report.warnings}});
  }
  return json_reply(out);
}

Reply patch(DeskState& desk, const Request& request) {
  const auto one = desk.cases.looked_at(request.value("case"));
  Painted painted;
  painted.anatomy = request.value("anatomy");
  const auto config = one->config();
  if (!config || config::corrected_field(*config, painted.anatomy).empty())
    throw Error(ExitCode::usage, "", "anatomy", "has no field that could be corrected");
  require_open(*one, painted.anatomy);
  const grid::Lattice& scan = grid::lattice_of(*one->scan());
  painted.voxels = decode_painted(request.body, scan);
  const DeskCase in_library = desk.library.find(request.value("case"));
  const auto field = one->field(painted.anatomy);
  std::size_t dropped = 0;
  // Where the field is not that of now, all that was painted counts: what is so already does no harm.
  if (field && one->is_current(painted.anatomy,
                               config::read_case_config(in_library.text_file(), desk.library.overrides_of(in_library))))
    dropped = drop_what_is_so(painted.voxels, *field, scan);
  const auto& voxels = painted.voxels.voxels;
  if (std::all_of(voxels.begin(), voxels.end(), [](std::uint8_t v) { return v == 0; }))
    throw Error(
        ExitCode::usage, "", painted.anatomy,
        "what was painted is so already: all that is to be added lies inside, all that is to be removed outside");
  const std::string what = save_patch(desk.library, request.value("case"), painted,
                                      {request.value("by"), request.value("why"), request.value("base")});
  return json_reply({{"done", what}, {"was_so_ml", double(dropped) * painted.voxels.voxel_volume_mm3() / 1000}});
}

Reply switch_correction(DeskState& desk, const Request& request) {
  const auto json = desk::json_of(request);
  switch_patch(desk.library, json.at("case"), json.at("id").get<int>(), json.at("on").get<bool>(), said_of(json));
  return json_reply({{"done", true}});
}

Reply draft(DeskState& desk, const Request& request) {
  const fs::path file = draft_file(desk.library, request);
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return bytes_reply("");
  const std::vector<char> bytes = read_file(file, max_draft_bytes);
  return bytes_reply({bytes.begin(), bytes.end()});
}

// What a person has not saved yet: it outlives a reload and a desk that ends. It is kept as it came, and read by pages
// alone.
Reply keep_draft(DeskState& desk, const Request& request) {
  const fs::path file = draft_file(desk.library, request);
  desk.library.find(request.value("case"));
  make_private_folder(file.parent_path().parent_path());
  make_private_folder(file.parent_path());
  if (request.body.empty()) {
    std::error_code ignored;
    fs::remove(file, ignored);
  } else {
    write_file(file, request.body);
  }
  return json_reply({{"done", true}});
}

}  // namespace

Routes change_routes() {
  return {
      {"api/case", {"GET", case_info}},   {"api/landmark", {"POST", landmark}},        {"api/holes", {"POST", holes}},
      {"api/value", {"POST", value}},     {"api/try", {"POST", try_change}},           {"api/tried", {"GET", tried}},
      {"api/patch", {"POST", patch}},     {"api/switch", {"POST", switch_correction}}, {"api/draft", {"GET", draft}},
      {"api/keep", {"POST", keep_draft}},
  };
}

}  // namespace trephine::desk
