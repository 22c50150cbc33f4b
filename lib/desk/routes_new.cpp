// SPDX-License-Identifier: GPL-3.0-or-later
// A new case: a folder or archive below the roots, its series, and a configuration.
#include <algorithm>
#include <map>

#include "base/hash.h"
#include "base/progress.h"
#include "base/text.h"
#include "base/write_file.h"
#include "config/config.h"
#include "config/config_root.h"
#include "config/yaml_document.h"
#include "config/yaml_edit.h"
#include "desk/desk_state.h"
#include "desk/draft.h"
#include "desk/hand_work.h"
#include "desk/scenes.h"
#include "dicom/import.h"
#include "picture/image.h"
#include "picture/slice.h"

namespace trephine::desk {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t max_listed = 2000;

/// A place that a page may name: "0" is the first root, "0/scans/a" lies below it.
fs::path chosen_path(const DeskLibrary& library, const std::string& text) {
  const std::vector<fs::path> roots = library.roots();
  const std::size_t slash = text.find('/');
  const auto number = parse_integer(text.substr(0, slash));
  if (!number || *number < 0 || *number >= static_cast<long long>(roots.size()))
    throw Error(ExitCode::usage, "", "path", "begins with no root of the library");
  const fs::path& root = roots[static_cast<std::size_t>(*number)];
  if (slash == std::string::npos) return config::absolute_path(root);
  std::string fault;
  const fs::path path = config::path_in_roots(root, text.substr(slash + 1), {config::absolute_path(root)}, fault);
  if (!fault.empty()) throw Error(ExitCode::usage, "", "path", "leaves the library's roots");
  return path;
}

dicom::ImportParams import_of(const std::string& series) {
  dicom::ImportParams params;
  params.series = series;
  return params;
}

/// Refuses a recipe of which no case can be made, before LIBRARY.yaml names it. Throws what read_case_config throws.
void require_usable(const DeskLibrary& library, const fs::path& recipe, const fs::path& scan,
                    const std::string& series) {
  config::ConfigOverrides overrides;
  overrides.roots = library.options().roots;
  overrides.series = scan;
  if (!series.empty()) overrides.set = {"import.series=" + series};
  const config::CaseConfig made = config::read_case_config(recipe, overrides);
  for (const config::CaseScan& further : made.scans)
    if (further.series.empty())
      throw Error(
          ExitCode::usage, recipe.filename().string(), "scans." + further.name + ".series",
          "is not set: it needs a further scan; write the folder of it into a copy of the recipe, and choose that");
}

/// The configurations that belong to one case alone, with its holes and landmarks, and its token.
std::map<fs::path, std::string> own_configs(DeskLibrary& library) {
  std::map<fs::path, std::string> own;
  for (const DeskCase& c : library.plan())
    if (c.copied_from.empty()) own.emplace(fs::absolute(c.config).lexically_normal(), c.token);
  return own;
}

Reply folders(DeskState& desk, const Request& request) {
  Json out = {{"path", request.value("path")}, {"folders", Json::array()}, {"archives", Json::array()}, {"files", 0}};
  if (request.value("path").empty()) {
    const std::vector<fs::path> roots = desk.library.roots();
    for (std::size_t i = 0; i < roots.size(); ++i)
      out["folders"].push_back({{"path", std::to_string(i)}, {"name", roots[i].filename().string()}});
    return json_reply(out);
  }
  const fs::path folder = chosen_path(desk.library, request.value("path"));
  out["name"] = folder.filename().string();
  std::vector<std::string> folders, archives;
  int files = 0;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    const std::string name = it->path().filename().string();
    if (name.front() == '.' || folders.size() + archives.size() > max_listed) continue;
    if (it->is_directory(ignored))
      folders.push_back(name);
    else if (it->path().extension() == ".zip" || it->path().extension() == ".ZIP")
      archives.push_back(name);
    else
      ++files;
  }
  if (error) throw Error(ExitCode::no_input, "", "path", "is no folder that can be read");
  std::sort(folders.begin(), folders.end());
  std::sort(archives.begin(), archives.end());
  for (const auto& [list, key] : {std::pair{&folders, "folders"}, {&archives, "archives"}})
    for (const std::string& name : *list)
      out[key].push_back({{"path", request.value("path") + "/" + name}, {"name", name}});
  out["files"] = files;
  return json_reply(out);
}

Reply series(DeskState& desk, const Request& request) {
  const Progress progress([](double) {}, &cancel_requested());
  const dicom::SeriesList list = dicom::list_series(chosen_path(desk.library, request.value("path")), {}, progress);
  Json out = Json::parse(dicom::list_json(list));
  Json recipes = Json::array();
  std::error_code error;
  const fs::path folder = fs::absolute(desk.library.options().config).parent_path();
  const std::map<fs::path, std::string> own = own_configs(desk.library);
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (own.count(it->path().lexically_normal()) > 0) continue;
    if (it->path().extension() != ".yaml" || it->path().filename().string().front() == '.') continue;
    try {
      const config::YamlNode file = config::read_yaml(it->path());
      // One that names its series is a case of its own, and no recipe.
      if (file.find("pipeline") && file.find("scene") && !file.find("series"))
        recipes.push_back({{"file", it->path().filename().string()},
                           {"pipeline", file.find("pipeline")->text},
                           {"scene", file.find("scene")->text},
                           {"about", first_comment(it->path())}});
    } catch (const Error&) {  // another file, or one that its own commands will explain
    }
  }
  std::sort(recipes.begin(), recipes.end(), [](const Json& a, const Json& b) { return a["file"] < b["file"]; });
  out["recipes"] = recipes;
  // What LIBRARY.yaml makes of its cases where they say nothing else.
  const config::YamlNode library = config::read_yaml(desk.library.options().config);
  const config::YamlNode* usual = library.find("config");
  out["recipe"] = usual ? usual->text : "";
  return json_reply(out);
}

// The middle slices of a series, as one picture. They show the face: it is looked at here and goes nowhere.
Reply series_picture(DeskState& desk, const Request& request) {
  const Progress progress([](double) {}, &cancel_requested());
  const dicom::ImportResult read = dicom::import_series(chosen_path(desk.library, request.value("path")),
                                                        import_of(request.value("series")), progress);
  std::vector<picture::Image> cells;
  for (const picture::SlicePlane plane :
       {picture::SlicePlane::axial, picture::SlicePlane::coronal, picture::SlicePlane::sagittal}) {
    picture::SliceParams params;
    params.plane = plane;
    params.longer_side_px = 180;
    params.marks = false;
    const auto range = picture::slice_range_mm(grid::lattice_of(read.volume), plane);
    params.position_mm = (range[0] + range[1]) / 2;
    cells.push_back(picture::slice_overlay(read.volume, params, {}));
  }
  return bytes_reply(picture::encode_png(picture::contact_sheet(cells, 3, {0, 0, 0})), "image/png");
}

Reply new_case(DeskState& desk, const Request& request) {
  const auto json = desk::json_of(request);
  const std::string token = json.at("case"), recipe = json.at("recipe"), series = json.value("series", "");
  cases::validate_case_token(token, ExitCode::usage);
  if (desk.library.options().config.empty()) throw Error(ExitCode::usage, "", "--config", "is needed: LIBRARY.yaml");
  const fs::path file = fs::absolute(desk.library.options().config).lexically_normal(), folder = file.parent_path();
  const fs::path scan = chosen_path(desk.library, json.at("path"));
  if (recipe.find('/') != std::string::npos || recipe.empty() || recipe.front() == '.')
    throw Error(ExitCode::usage, "", "recipe", "must be a configuration beside LIBRARY.yaml");
  const DeskLock lock(desk.library);
  const auto own = own_configs(desk.library);
  if (const auto of = own.find(folder / recipe); of != own.end())
    throw Error(ExitCode::usage, recipe, "recipe",
                "is the configuration of " + of->second + " alone, with its holes and landmarks: choose another");
  const std::vector<char> bytes = read_file(file, 1 << 20);
  Json entry = {{"case", token}, {"series", scan.lexically_relative(folder).string()}, {"config", recipe}};
  if (!series.empty()) entry["set"] = {{"import.series", series}};
  const std::string text =
      config::edited_yaml({bytes.begin(), bytes.end()}, {{{"cases", "+"}, yaml_of_json(entry)}}, file);
  {
    const Draft draft(file, text);
    draft.judged([&](const fs::path& f) {
      return library::read_library_config(f, {{}, {}, desk.library.options().roots});
    });
  }
  require_usable(desk.library, folder / recipe, scan, series);
  write_file(file, text);
  desk.library.plan();
  return json_reply({{"done", token}});
}

}  // namespace

Routes new_case_routes() {
  return {
      {"api/folders", {"GET", folders}},
      {"api/series", {"GET", series}},
      {"api/picture", {"GET", series_picture}},
      {"api/new", {"POST", new_case}},
  };
}

}  // namespace trephine::desk
