// SPDX-License-Identifier: GPL-3.0-or-later
// Corrections by hand, which a case's configuration names by anatomy, become a step of the anatomy.
#include <algorithm>

#include "config/corrected_field.h"
#include "config/reading.h"
#include "segmentation/correct.h"

namespace trephine::config {
namespace {

constexpr const char* correct_step = "correct";

/// Calls visit(source) for every port of a step or scan step that reads an output by name.
template <class Config, class Visit>
void for_each_source(Config& config, const Visit& visit) {
  for (auto& anatomy : config.anatomies)
    for (auto& step : anatomy.steps)
      for (auto& [port, source] : step.ports) visit(source);
  for (auto& step : config.scan_steps)
    for (auto& [port, source] : step.ports) visit(source);
}

/// The step whose field is corrected: of those whose field another step reads by its name, the last one, else the last
/// one before the surface that keeps the scan's voxels. -1 where the anatomy has no field.
int corrected_step(const CaseConfig& config, const RecipeAnatomy& anatomy) {
  int last = -1, read = -1;
  for (std::size_t i = 0; i < anatomy.steps.size(); ++i) {
    if (!anatomy.steps[i].type->can_be_corrected()) continue;
    last = int(i);
    for_each_source(config, [&](const std::string& source) {
      if (source == anatomy.name + "." + anatomy.steps[i].type->name) read = int(i);
    });
  }
  return read >= 0 ? read : last;
}

/// Makes the step, right after the one whose field it corrects. Returns a fault, or "".
std::string add_step(CaseConfig& config, RecipeAnatomy& anatomy, const std::string& file) {
  const int at = corrected_step(config, anatomy);
  if (at < 0) return "it has no field that could be corrected";
  const std::string before = anatomy.name + "." + anatomy.steps[std::size_t(at)].type->name,
                    now = anatomy.name + "." + correct_step;
  for_each_source(config, [&](std::string& source) {
    if (source == before) source = now;
  });
  segmentation::CorrectParams params;
  params.file = file;
  anatomy.steps.insert(anatomy.steps.begin() + at + 1,
                       RecipeStep{&stages::stage_named(correct_step), AnyParams::make(params), {}, {}});
  return "";
}

RecipeAnatomy* anatomy_to_correct(CaseConfig& config, const std::string& name) {
  for (RecipeAnatomy& a : config.anatomies)
    if (a.name == name) return &a;
  return nullptr;
}

}  // namespace

std::string corrected_field(const CaseConfig& config, const std::string& anatomy) {
  const RecipeAnatomy* of = config.find_anatomy(anatomy);
  if (!of) return "";
  for (std::size_t i = 1; i < of->steps.size(); ++i)
    if (of->steps[i].type->name == correct_step) return anatomy + "." + of->steps[i - 1].type->name;
  const int step = corrected_step(config, *of);
  return step < 0 ? "" : anatomy + "." + of->steps[std::size_t(step)].type->name;
}

void add_corrections(ConfigReading& reading, const Named<SaidPath>& corrections, const std::vector<std::string>& set,
                     const std::function<void(const std::string& where, const std::string& what)>& fault) {
  CaseConfig& config = reading.out;
  if (config.anatomies.empty()) return;
  for (const auto& [name, said] : corrections) {
    const std::string where = "corrections." + name;
    std::string reported;
    reading.in_root(reading.file, said.path, reported);
    if (!reported.empty()) continue;
    RecipeAnatomy* anatomy = anatomy_to_correct(config, name);
    const std::string what = !anatomy ? reading.fault_of_anatomy(name)
                             : anatomy->find_step(correct_step)
                                 ? "the recipe corrects it already: set " + name + "." + correct_step + ".file"
                                 : add_step(config, *anatomy, said.path);
    if (!what.empty()) fault(where, what);
  }
  // A value that is set makes the step, too; its file comes with the other values.
  const std::string ending = std::string(".") + correct_step + ".file";
  for (const std::string& path : set) {
    if (path.size() <= ending.size() || path.compare(path.size() - ending.size(), ending.size(), ending) != 0) continue;
    RecipeAnatomy* anatomy = anatomy_to_correct(config, path.substr(0, path.size() - ending.size()));
    if (anatomy && !anatomy->find_step(correct_step)) add_step(config, *anatomy, "");
  }
}

}  // namespace trephine::config
