// SPDX-License-Identifier: GPL-3.0-or-later
// Which scene a case is made for: the scenes that lie beside its own, and the choice of another one.
#include <algorithm>
#include <fstream>

#include "base/text.h"
#include "config/config_root.h"
#include "config/yaml_document.h"
#include "desk/desk_state.h"
#include "desk/hand_work.h"
#include "desk/scenes.h"

namespace trephine::desk {
namespace fs = std::filesystem;
namespace {

Reply scene(DeskState& desk, const Request& request) {
  const auto json = desk::json_of(request);
  const std::string token = json.at("case"), wanted = json.at("scene");
  const DeskLock lock(desk.library);
  const DeskCase one = desk.library.find(token);
  const Json scenes = scenes_of(desk.library, one);
  const auto found = std::find_if(scenes.begin(), scenes.end(), [&](const Json& s) { return s["file"] == wanted; });
  if (found == scenes.end())
    throw Error(ExitCode::usage, "", "scene", printable(wanted) + ", must be a scene beside the one that the case has");
  HandChange change = change_of(json);
  change.kind = "scene";
  change.what = "scene: " + wanted;
  change.changes = {{{"scene"}, config::yaml_scalar(wanted)}};
  // A scene that cuts holes asks which; that there is none yet must be said.
  if ((*found)["cuts_holes"].get<bool>() && !config::read_yaml(one.text_file()).find("burr_holes"))
    change.changes.push_back({{"burr_holes"}, "[]"});
  std::vector<HandEntry> journal = read_journal(one);
  save_change(desk.library, one, change, journal);
  return json_reply({{"done", change.what}});
}

}  // namespace

std::string first_comment(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string out;
  for (std::string line; std::getline(in, line) && line.rfind('#', 0) == 0 && out.size() < 500;) {
    const std::string text(trimmed(printable(line.substr(1))));
    if (text.rfind("trephine ", 0) == 0 || text.rfind("--", 0) == 0) continue;  // what one would type elsewhere
    out += (out.empty() ? "" : " ") + text;
  }
  return out;
}

Json scenes_of(const DeskLibrary& library, const DeskCase& one) {
  const config::YamlNode file = config::read_yaml(one.text_file());
  const config::YamlNode* said = file.find("scene");
  Json out = Json::array();
  if (!said) return out;
  const fs::path own = said->text, beside = own.parent_path();
  std::string fault;
  std::vector<fs::path> roots = {config::root_of(one.text_file())};
  for (const fs::path& root : library.roots()) roots.push_back(config::absolute_path(root));
  const fs::path folder =
      config::path_in_roots(one.text_file().parent_path(), own.string(), roots, fault).parent_path();
  if (!fault.empty()) return out;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const fs::path name = it->path().filename();
    if (name.extension() != ".yaml" || name.string().front() == '.') continue;
    try {
      const config::YamlNode scene = config::read_yaml(it->path());
      if (!scene.find("anatomies") && !scene.find("haptic")) continue;
      out.push_back({{"file", (beside / name).string()},
                     {"about", first_comment(it->path())},
                     {"cuts_holes", scene.find("burr_holes") != nullptr},
                     {"chosen", (beside / name) == own}});
    } catch (const Error&) {  // one that its own commands will explain
    }
  }
  std::sort(out.begin(), out.end(), [](const Json& a, const Json& b) { return a["file"] < b["file"]; });
  return out;
}

Routes scene_routes() {
  return {
      {"api/scene", {"POST", scene}},
  };
}

}  // namespace trephine::desk
