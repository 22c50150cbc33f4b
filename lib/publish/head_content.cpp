// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/head_content.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/refusal.h"
#include "publish/findings_content.h"

namespace trephine::publish {
namespace {

const cases::CaseLandmark* find(const std::vector<cases::CaseLandmark>& all, const std::string& name) {
  for (const cases::CaseLandmark& l : all)
    if (l.name == name) return &l;
  return nullptr;
}

std::string two_digits(double v) { return to_text(ParameterValue(std::round(100 * v) / 100)); }

// The one of that name; of a family the surest.
const cases::CaseLandmark* surest(const std::vector<cases::CaseLandmark>& all, const std::string& name) {
  const cases::CaseLandmark* best = find(all, name);
  if (best) return best;
  for (const cases::CaseLandmark& l : all)
    if (l.name.rfind(name + "_", 0) == 0 && (!best || l.confidence > best->confidence)) best = &l;
  return best;
}

void require(const config::SceneLandmark& wanted, const std::vector<cases::CaseLandmark>& known) {
  const cases::CaseLandmark* l = surest(known, wanted.name);
  if (l && l->confidence >= wanted.min_confidence) return;
  if (l && l->name != wanted.name)
    throw refusal("landmarks." + wanted.name,
                  "none was found surely (best: " + l->name + " with confidence " + two_digits(l->confidence) +
                      ", the scene needs " + two_digits(wanted.min_confidence) +
                      "); is this a scan of what the scene is of",
                  {"if it is, give it in the case's configuration, in mm, LPS: `landmarks: {" + l->name +
                   ": [x, y, z]}` and the points that belong to it, or a `landmarks_file`"});
  throw refusal("landmarks." + wanted.name,
                l ? "was found with confidence " + two_digits(l->confidence) + ", the scene needs " +
                        two_digits(wanted.min_confidence)
                  : std::string("was not found and the scene needs it"),
                {"give it in the case's configuration, in mm, LPS: `landmarks: {" + wanted.name +
                 ": [x, y, z]}`, or a `landmarks_file`"});
}

}  // namespace

void require_landmarks(const config::CaseConfig& config, const std::vector<cases::CaseLandmark>& known) {
  for (const config::SceneLandmark& wanted : config.scene_landmarks) require(wanted, known);
}

void add_landmarks(const config::CaseConfig& config, const pipeline::Graph& graph,
                   const std::vector<pipeline::NodeResult>& results, cases::CaseManifest& manifest) {
  manifest.landmarks = config.landmarks;
  if (const int found = graph.result(stages::DataKind::landmarks); found >= 0)
    manifest.landmarks =
        std::get<std::shared_ptr<const head::HeadLandmarks>>(results[static_cast<std::size_t>(found)].data)->landmarks;
  require_landmarks(config, manifest.landmarks);
  for (const auto& [landmark, anatomy] : config.roles.targets)
    if (const cases::CaseLandmark* l = config.is_shown(anatomy.name) ? find(manifest.landmarks, landmark) : nullptr)
      manifest.targets.push_back({l->name, l->position_mm, l->confidence, anatomy.name});
}

void add_figures(const config::CaseConfig& config, const std::vector<stages::CaseParts>& parts,
                 cases::CaseManifest& manifest) {
  const auto add = [&](const Named<ParameterValue>& more) {
    manifest.figures.insert(manifest.figures.end(), more.begin(), more.end());
  };
  for (const stages::CaseParts& p : parts) {
    if (!p.head) continue;
    consistency::AnatomyResult of_head = *p.head;
    head::HeadFigures& f = of_head.head;
    // They were taken from the fields; of what is published there is one volume, its surface's.
    for (const cases::CaseAnatomy& a : manifest.anatomies)
      if (std::optional<double>* ml = head::volume_of(f, a.name); ml && *ml) *ml = a.volume_ml;
    const std::string& class_of = config.roles.class_of;
    if (!class_of.empty() && f.head_class != head::HeadClass::unknown && is_in_doubt(manifest.findings, class_of))
      f.head_class = head::HeadClass::uncertain;
    add(figures_of(of_head));
    if (!class_of.empty()) manifest.figures.emplace_back("class_of", class_of);
  }
  for (const stages::CaseParts& p : parts) add(p.checks);
  for (const stages::CaseParts& p : parts) add(p.changes);
}

}  // namespace trephine::publish
