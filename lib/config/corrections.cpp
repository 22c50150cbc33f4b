// SPDX-License-Identifier: GPL-3.0-or-later
// Corrections by hand, which a case's configuration names by anatomy, become a step of the anatomy.
#include <algorithm>

#include "config/reading.h"
#include "segmentation/correct.h"

namespace trephine {
namespace {

constexpr const char* correct_step = "correct";

/// Calls visit(source) for every port of a step or scan step that reads an output by name.
template <class Visit>
void for_each_source(CaseConfig& config, const Visit& visit) {
  for (RecipeAnatomy& anatomy : config.anatomies)
    for (RecipeStep& step : anatomy.steps)
      for (auto& [port, source] : step.ports) visit(source);
  for (RecipeStep& step : config.scan_steps)
    for (auto& [port, source] : step.ports) visit(source);
}

/// The step whose field is corrected: of those whose field another step reads by its name, the last one, else the last
/// one before the surface. -1 where the anatomy has no field.
int corrected_step(CaseConfig& config, const RecipeAnatomy& anatomy) {
  int last = -1, read = -1;
  for (std::size_t i = 0; i < anatomy.steps.size(); ++i) {
    if (anatomy.steps[i].type->output != DataKind::field) continue;
    last = int(i);
    for_each_source(config, [&](const std::string& source) {
      if (source == anatomy.name + "." + anatomy.steps[i].type->name) read = int(i);
    });
  }
  return read >= 0 ? read : last;
}

}  // namespace

void add_corrections(ConfigReading& reading, const Named<SaidPath>& corrections,
                     const std::function<void(const std::string& where, const std::string& what)>& fault) {
  CaseConfig& config = reading.out;
  if (config.anatomies.empty()) return;
  for (const auto& [name, said] : corrections) {
    const std::string where = "corrections." + name;
    std::string reported;
    reading.in_root(reading.file, said.path, reported);
    if (!reported.empty()) continue;
    const auto anatomy = std::find_if(config.anatomies.begin(), config.anatomies.end(),
                                      [&n = name](const RecipeAnatomy& a) { return a.name == n; });
    if (anatomy == config.anatomies.end()) {
      fault(where, reading.fault_of_anatomy(name));
      continue;
    }
    if (anatomy->find_step(correct_step)) {
      fault(where, "the recipe corrects it already: set " + name + "." + correct_step + ".file");
      continue;
    }
    const int at = corrected_step(config, *anatomy);
    if (at < 0) {
      fault(where, "it has no field that could be corrected");
      continue;
    }
    const std::string before = name + "." + anatomy->steps[std::size_t(at)].type->name, now = name + "." + correct_step;
    for_each_source(config, [&](std::string& source) {
      if (source == before) source = now;
    });
    CorrectParams params;
    params.file = said.path;
    anatomy->steps.insert(anatomy->steps.begin() + at + 1,
                          RecipeStep{&stage_named(correct_step), AnyParams::make(params), {}});
  }
}

}  // namespace trephine
