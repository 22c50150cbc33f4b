// SPDX-License-Identifier: GPL-3.0-or-later
// Every stage, with its parameters as declared, on every extreme of the input.
#include "base/text.h"
#include "outcome.h"
#include "subjects.h"

namespace trephine::extremes {
namespace {

std::vector<Case> cases_of(const stages::StageType& stage) {
  std::vector<Case> cases;
  for (const Subject& subject : subjects_of(stage)) {
    const std::string prefix = subject.label == stage.name ? "" : subject.label.substr(stage.name.size() + 2) + "; ";
    for (const ExtremeScene& extreme : extreme_scenes(subject.body))
      cases.push_back({prefix + extreme.name,
                       [subject, &extreme] {
                         const Scene& scene = extreme.scene();
                         stages::StageInputs inputs;
                         if (!fill(inputs, subject, scene))
                           return "no surface to begin with: contour says: " + scene.no_surface;
                         return outcome_of_stage(*subject.stage, params_of(subject), inputs);
                       },
                       is_slow(subject, "", extreme.name)});
  }
  return cases;
}

}  // namespace

std::vector<Section> input_sections() {
  std::vector<Section> sections;
  for (const stages::StageType& stage : all_stages())
    sections.push_back({"inputs_" + stage.name, "Inputs of " + stage.name, "", [&stage] { return cases_of(stage); }});
  return sections;
}

}  // namespace trephine::extremes
