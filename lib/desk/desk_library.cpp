// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/desk_library.h"

#include <algorithm>
#include <map>

#include "base/error.h"
#include "base/error_text.h"
#include "base/progress.h"
#include "config/config_root.h"
#include "config/yaml_document.h"
#include "desk/links.h"

namespace trephine::desk {
namespace fs = std::filesystem;
namespace {

/// Where LIBRARY.yaml lists cases and phantoms, by their names.
std::map<std::string, std::vector<std::string>> places_of(const config::YamlNode& file) {
  std::map<std::string, std::vector<std::string>> out;
  const auto add = [&](const config::YamlNode* list, const char* key, const std::vector<std::string>& path) {
    for (std::size_t i = 0; list && i < list->items.size(); ++i)
      if (const config::YamlNode* name = list->items[i].find(key)) {
        out[name->text] = path;
        out[name->text].push_back(std::to_string(i));
      }
  };
  add(file.find("cases"), "case", {"cases"});
  if (const config::YamlNode* phantoms = file.find("phantoms"))
    add(phantoms->find("list"), "name", {"phantoms", "list"});
  return out;
}

/// Whether a configuration is of one case, by its name or its key `case`: a recipe's example is not, though a library
/// may have only one case of it so far.
bool is_own(const fs::path& config, const std::string& token) {
  if (config.stem() == token) return true;
  const config::YamlNode file = config::read_yaml(config);
  const config::YamlNode* named = file.find("case");
  return named && named->text == token;
}

}  // namespace

std::vector<fs::path> DeskLibrary::roots() const {
  std::vector<fs::path> out;
  if (!options_.config.empty()) out.push_back(config::root_of(options_.config));
  for (const fs::path& root : options_.roots) out.push_back(config::absolute_path(root));
  return out;
}

std::vector<DeskCase> DeskLibrary::plan() {
  if (options_.config.empty())
    throw Error(ExitCode::usage, "", "--config", "is needed: the LIBRARY.yaml that says what the library is made of");
  const Progress progress([](double) {}, &cancel_requested());
  const library::LibraryConfig config = library::read_library_config(options_.config, {{}, {}, options_.roots});
  const config::YamlNode file = config::read_yaml(options_.config);
  const auto places = places_of(file);
  library::PlanOptions how;
  how.program_version = options_.program_version;
  how.write = false;
  const library::LibraryState state(fs::absolute(options_.library).lexically_normal());
  const library::LibraryPlan plan = library::make_plan(config, state, how, progress);
  std::map<fs::path, int> users;
  for (const library::LibraryCase& c : config.cases) ++users[c.config];
  std::vector<DeskCase> out;
  for (const library::PlannedCase& c : plan.cases) {
    DeskCase one;
    one.token = c.token;
    one.entry = c.entry;
    one.series = c.series;
    one.reasons = c.reasons;
    if (c.fault) one.fault = error_text(*c.fault);
    const auto place = places.find(c.token);
    const config::YamlNode* item = nullptr;
    if (place != places.end()) {
      one.at = place->second;
      const config::YamlNode* list = file.find(one.at[0]);
      if (one.at.size() == 3) list = list->find(one.at[1]);
      item = &list->items[static_cast<std::size_t>(std::stoul(one.at.back()))];
    }
    if (!item)
      one.fixed =
          c.entry.suffix.empty()
              ? "the case was found by a pattern of `series`: list it under `cases` of LIBRARY.yaml first"
              : "LIBRARY.yaml makes several cases of each patient (`configs`): list this one under `cases` first";
    if (item && item->find("config") && users[c.entry.config] == 1 && is_own(c.entry.config, c.token)) {
      one.config = c.entry.config;
    } else {
      one.copied_from = c.entry.config;
      one.config = c.entry.config.parent_path() / (c.token + ".yaml");
      std::error_code ignored;
      if (one.fixed.empty() && fs::exists(one.config, ignored) && one.config != c.entry.config)
        one.fixed = one.config.filename().string() +
                    " is there already and is not the case's configuration: name it in LIBRARY.yaml, or move it away";
    }
    out.push_back(std::move(one));
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  planned_ = out;
  return out;
}

DeskCase DeskLibrary::find(const std::string& token) {
  const auto without_links = [](DeskCase c) {
    require_no_links(c.hand_folder());
    return c;
  };
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const DeskCase& c : planned_)
      if (c.token == token) return without_links(c);
  }
  for (const DeskCase& c : plan())
    if (c.token == token) return without_links(c);
  throw Error(ExitCode::no_input, "", "case", "LIBRARY.yaml has no such case");
}

config::ConfigOverrides DeskLibrary::overrides_of(const DeskCase& one) const {
  config::ConfigOverrides out;
  out.set = one.entry.set;
  out.roots = options_.roots;
  out.landmarks = one.entry.landmarks;
  out.series = one.series;
  out.case_token = one.token;
  return out;
}

}  // namespace trephine::desk
