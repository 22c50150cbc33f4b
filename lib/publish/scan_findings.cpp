// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/scan_findings.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/joined.h"
#include "stages/warning_kind.h"

namespace trephine::publish {
namespace {

constexpr double how_sure = 0.6, doubtful_point = 0.4;

/// Of each node, whether it is made of the other one; sources come before their readers.
std::vector<char> made_of(const pipeline::Graph& graph, int source) {
  std::vector<char> is(graph.nodes.size());
  is[std::size_t(source)] = 1;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i)
    for (const auto& [port, from] : graph.nodes[i].sources)
      if (is[std::size_t(from)]) is[i] = 1;
  return is;
}

// By the recipe's steps alone: a burr hole that was aimed by the other scan makes no bone of it.
std::vector<std::string> anatomies_made_of(const config::CaseConfig& config, const pipeline::Graph& graph, int scan) {
  const std::vector<char> is = made_of(graph, scan);
  std::vector<std::string> names;
  for (const config::RecipeAnatomy& a : config.anatomies) {
    if (!config.is_shown(a.name)) continue;
    if (std::any_of(a.steps.begin(), a.steps.end(), [&](const config::RecipeStep& step) {
          const int node = graph.find(a.name + "." + step.type->name);
          return node >= 0 && is[std::size_t(node)];
        }))
      names.push_back(a.name);
  }
  return names;
}

// A target and the landmark of its name, where no person gave it.
void doubt(cases::CaseTarget& target, cases::CaseManifest& manifest) {
  const auto point = std::find_if(manifest.landmarks.begin(), manifest.landmarks.end(),
                                  [&](const cases::CaseLandmark& l) { return l.name == target.name; });
  if (point != manifest.landmarks.end() && point->source == "given") return;
  target.confidence = std::min(target.confidence, doubtful_point);
  if (point != manifest.landmarks.end()) point->confidence = std::min(point->confidence, doubtful_point);
}

}  // namespace

const char* const other_patient = "other_patient";

std::vector<cases::CaseFinding> findings_of_scans(const config::CaseConfig& config, const pipeline::Graph& graph,
                                                  const std::vector<stages::CaseParts>& parts, Vec3 middle_mm) {
  std::vector<cases::CaseFinding> all;
  for (const auto& [name, node] : graph.scans) {
    const std::optional<double> stretch = parts[std::size_t(node)].doubted_scale_ratio;
    if (!stretch) continue;
    cases::CaseFinding f;
    f.kind = other_patient;
    f.where = "the whole scan " + name;
    f.side = "middle";
    f.position_mm = middle_mm;
    f.confidence = how_sure;
    f.concerns = anatomies_made_of(config, graph, node);
    f.figures = {{"scale_ratio", *stretch}};
    const std::string of = joined(f.concerns);
    f.text = fmt::format("the scan {} may be another patient's: it fits the CT best stretched by {:.1f} %{}", name,
                         100 * *stretch, of.empty() ? "" : ", and of it are made " + of);
    all.push_back(std::move(f));
  }
  return all;
}

bool may_be_of_another(const cases::CaseManifest& manifest, const std::string& anatomy) {
  return std::any_of(manifest.findings.begin(), manifest.findings.end(), [&](const cases::CaseFinding& f) {
    return f.kind == other_patient && std::find(f.concerns.begin(), f.concerns.end(), anatomy) != f.concerns.end();
  });
}

void doubt_the_targets(cases::CaseManifest& manifest) {
  for (cases::CaseTarget& target : manifest.targets)
    if (may_be_of_another(manifest, target.anatomy)) doubt(target, manifest);
}

void doubt_landmarks(const Warnings& warnings, cases::CaseManifest& manifest) {
  if (std::none_of(warnings.begin(), warnings.end(),
                   [](const Warning& w) { return stages::kind_of(w).about_landmarks; }))
    return;
  for (cases::CaseTarget& target : manifest.targets) doubt(target, manifest);
  for (cases::CaseLandmark& l : manifest.landmarks)
    if (l.source != "given") l.confidence = std::min(l.confidence, doubtful_point);
}

}  // namespace trephine::publish
