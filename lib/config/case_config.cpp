// SPDX-License-Identifier: GPL-3.0-or-later
// What a read configuration answers, and what its readers share.
#include <algorithm>
#include <utility>

#include "base/joined.h"
#include "config/config_root.h"
#include "config/reading.h"

namespace trephine::config {
namespace fs = std::filesystem;

ConfigReading::ConfigReading(const fs::path& f, const ConfigOverrides& o) : file(f), overrides(o) {
  roots.push_back(root_of(file));
  for (const fs::path& root : o.roots) roots.push_back(absolute_path(root));
}

fs::path ConfigReading::in_root(const fs::path& from, const std::string& text, std::string& fault) const {
  return path_in_roots(fs::absolute(from).parent_path(), text, roots, fault);
}

ValueOrigin ConfigReading::origin(ValueSource source, const fs::path& from, const YamlNode& at) const {
  return {source, from.string() + ":" + std::to_string(at.line) + ":" + std::to_string(at.column),
          absolute_path(from).parent_path()};
}

std::vector<std::string> ConfigReading::anatomy_names() const {
  std::vector<std::string> names;
  for (const RecipeAnatomy& a : out.anatomies) names.push_back(a.name);
  return names;
}

std::string ConfigReading::fault_of_anatomy(const std::string& name) const {
  if (const RecipeAnatomy* anatomy = out.find_anatomy(name)) {
    const bool is_labels = !anatomy->steps.empty() && anatomy->steps.back().type->output == stages::DataKind::labels;
    return is_labels ? name + ", it gives labels and no surface" : "";
  }
  return name + ", the pipeline has no such anatomy" + did_you_mean(name, anatomy_names());
}

std::string ConfigReading::fault_of_landmark(const std::string& name) const {
  const RecipeStep* looked_for = out.landmarks_step();
  if (looked_for && looked_for->type->finds(name)) return "";
  std::vector<std::string> known;
  if (looked_for)
    for (const stages::StagePoint& point : looked_for->type->points) known.push_back(point.name);
  for (const cases::CaseLandmark& l : out.landmarks) known.push_back(l.name);
  if (std::find(known.begin(), known.end(), name) != known.end()) return "";
  return name + ", no such landmark is given" + (looked_for ? " or can be found" : "") + did_you_mean(name, known);
}

std::string CaseTrade::front_names() const {
  return joined(fronts, ", ", [](const fs::path& file) { return file.filename().string(); });
}

const RecipeStep* RecipeAnatomy::find_step(const std::string& stage) const {
  for (const RecipeStep& s : steps)
    if (s.type->name == stage) return &s;
  return nullptr;
}

const RecipeAnatomy* CaseConfig::find_anatomy(const std::string& name) const {
  for (const RecipeAnatomy& a : anatomies)
    if (a.name == name) return &a;
  return nullptr;
}

std::string CaseConfig::in_role(const std::string& role) const {
  const AnyParams all = AnyParams::make(roles);
  for (const ParameterLeaf& leaf : leaves_of(all))
    if (leaf.path == role) return std::get<std::string>(leaf.value());
  throw Error(ExitCode::internal, "", role, "no recipe has such a role");
}

bool CaseConfig::needs_landmarks() const {
  if (!landmarks_step()) return false;
  if (!scene_landmarks.empty()) return true;
  const auto given = landmark_positions_mm();
  return std::any_of(burr_holes.begin(), burr_holes.end(), [&](const CaseDrill& hole) {
    return !boolean::missing_landmark(hole.params.as<boolean::BurrHoleParams>(), given).empty();
  });
}

const RecipeStep* CaseConfig::landmarks_step() const {
  for (const RecipeStep& s : scan_steps)
    if (s.type->output == stages::DataKind::landmarks) return &s;
  return nullptr;
}

const RecipeStep* CaseConfig::face_step() const {
  for (const RecipeStep& s : scan_steps)
    if (s.type->effect == stages::StageEffect::removes_face) return &s;
  return nullptr;
}

bool CaseConfig::is_felt(const std::string& anatomy) const {
  return std::any_of(haptic.shapes.begin(), haptic.shapes.end(),
                     [&](const SceneShape& s) { return s.name == anatomy; });
}

bool CaseConfig::is_shown(const std::string& anatomy) const { return is_felt(anatomy) || find_shown(anatomy); }

const SceneAnatomy* CaseConfig::find_shown(const std::string& anatomy) const {
  for (const SceneAnatomy& a : scene)
    if (a.name == anatomy) return &a;
  return nullptr;
}

bool CaseConfig::can_do_without(const std::string& anatomy) const {
  const SceneAnatomy* a = find_shown(anatomy);
  return a && (a->may_be_missing || !a->stand_in.empty());
}

void CaseConfig::leave_out(const std::string& anatomy) {
  const auto erase = [&](auto& list, const auto& name_of) {
    list.erase(std::remove_if(list.begin(), list.end(), [&](const auto& item) { return name_of(item) == anatomy; }),
               list.end());
  };
  erase(scene, [](const SceneAnatomy& a) { return a.name; });
  erase(drilled, [](const SceneDrill& d) { return d.anatomy; });
  erase(haptic.shapes, [](const SceneShape& s) { return s.name; });
  // A copy: the values that are shown refer to what was read.
  auto params = haptic.params.as<stages::VoxelizeStageParams>();
  erase(params.shapes, [](const auto& s) { return s.first; });
  erase(params.drill, [](const auto& d) { return d.first; });
  for (auto& [name, shape] : params.shapes)
    if (shape.clear_of == anatomy) shape.clear_of.clear();
  haptic.params = AnyParams::make(params);
}

std::string CaseConfig::let_stand_in(const std::string& anatomy) {
  const auto wanted =
      std::find_if(scene.begin(), scene.end(), [&](const SceneAnatomy& a) { return a.name == anatomy; });
  const std::string by = std::exchange(wanted->stand_in, ""), refused = "refused_" + anatomy, before = anatomy + ".";
  RecipeAnatomy stand_in = *find_anatomy(by);
  stand_in.name = anatomy;
  const auto field = std::find_if(stand_in.steps.begin(), stand_in.steps.end(),
                                  [](const RecipeStep& s) { return s.type->output == stages::DataKind::field; });
  const auto rename = [&](RecipeStep& step) {
    for (auto& [port, source] : step.ports) {
      if (source.rfind(before, 0) != 0) continue;
      const bool is_check = step.type->is_check() && field != stand_in.steps.end();
      source = is_check ? before + field->type->name : refused + source.substr(anatomy.size());
    }
  };
  for (RecipeAnatomy& a : anatomies) {
    if (a.name == anatomy) a.name = refused;
    for (RecipeStep& step : a.steps) rename(step);
  }
  for (RecipeStep& step : scan_steps) rename(step);
  anatomies.push_back(std::move(stand_in));
  return by;
}

std::string CaseConfig::target_in(const std::string& landmark) const {
  const SaidAnatomy* anatomy = find_item(roles.targets, landmark);
  return anatomy ? anatomy->name : "";
}

std::map<std::string, Vec3> CaseConfig::landmark_positions_mm() const {
  std::map<std::string, Vec3> all;
  for (const cases::CaseLandmark& l : landmarks) all[l.name] = l.position_mm;
  return all;
}

}  // namespace trephine::config
