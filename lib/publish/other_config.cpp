// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/other_config.h"

#include "base/joined.h"
#include "publish/left_out.h"

#include <algorithm>

namespace trephine::publish {
namespace {

namespace fs = std::filesystem;
using config::CaseConfig;

constexpr std::size_t max_files = 64;

std::vector<std::string> recipe_of(const CaseConfig& config) {
  std::vector<std::string> names;
  for (const config::RecipeAnatomy& a : config.anatomies) names.push_back(a.name);
  return names;
}

bool does_without(const CaseConfig& other, const CaseConfig& config, const std::string& anatomy) {
  if (!other.series.empty() || recipe_of(other) != recipe_of(config)) return false;
  bool shares = false;
  for (const config::SceneAnatomy& a : other.scene) {
    if (a.name == anatomy) return false;
    shares = shares || config.find_shown(a.name);
  }
  return shares && !other.is_felt(anatomy);
}

}  // namespace

std::vector<std::string> configs_without(const fs::path& file, const CaseConfig& config, const std::string& anatomy) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (fs::directory_iterator at(file.parent_path().empty() ? "." : file.parent_path(), failed), end;
       !failed && at != end; at.increment(failed))
    if (at->path().extension() == ".yaml" && at->path().filename() != file.filename()) files.push_back(at->path());
  std::sort(files.begin(), files.end());
  if (files.size() > max_files) files.resize(max_files);
  std::vector<std::string> names;
  for (const fs::path& other : files) try {
      if (does_without(config::read_case_config(other), config, anatomy)) names.push_back(other.filename().string());
    } catch (const Error&) {
      continue;  // it configures something else, or wants more than a file
    }
  return names;
}

std::optional<Error> with_other_configs(const Error& e, const fs::path& file, const CaseConfig& config) {
  if (e.code() != ExitCode::quality) return {};
  const bool of_surface = e.stage().empty() && is_of_output(e.cause()) && !e.about().empty();
  const std::string anatomy = of_surface ? e.about().front() : anatomy_of_stage(config, e);
  if (anatomy.empty()) return {};
  const std::string names = joined(configs_without(file, config, anatomy));
  if (names.empty()) return {};
  return Error(e).reworded(e.message() + ("; a case without " + anatomy + " is made by " + names));
}

}  // namespace trephine::publish
