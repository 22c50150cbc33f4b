// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/head_content.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/refusal.h"

namespace trephine {
namespace {

const CaseLandmark* find(const std::vector<CaseLandmark>& all, const std::string& name) {
  for (const CaseLandmark& l : all)
    if (l.name == name) return &l;
  return nullptr;
}

std::string two_digits(double v) { return to_text(ParameterValue(std::round(100 * v) / 100)); }

// The one of that name; of a family the surest.
const CaseLandmark* surest(const std::vector<CaseLandmark>& all, const std::string& name) {
  const CaseLandmark* best = find(all, name);
  if (best) return best;
  for (const CaseLandmark& l : all)
    if (l.name.rfind(name + "_", 0) == 0 && (!best || l.confidence > best->confidence)) best = &l;
  return best;
}

void require(const SceneLandmark& wanted, const std::vector<CaseLandmark>& known) {
  const CaseLandmark* l = surest(known, wanted.name);
  if (l && l->confidence >= wanted.min_confidence) return;
  if (l && l->name != wanted.name)
    throw refusal("landmarks." + wanted.name,
                  "none was found surely (best: " + l->name + " with confidence " + two_digits(l->confidence) +
                      ", the scene needs " + two_digits(wanted.min_confidence) +
                      "); is this a scan of what the scene is of",
                  {"if it is, give it in mm, LPS: `landmarks: {" + l->name +
                   ": [x, y, z]}` and the points that belong to it, or a `landmarks_file`"});
  throw refusal("landmarks." + wanted.name,
                l ? "was found with confidence " + two_digits(l->confidence) + ", the scene needs " +
                        two_digits(wanted.min_confidence)
                  : std::string("was not found and the scene needs it"),
                {"give it in mm, LPS: `landmarks: {" + wanted.name + ": [x, y, z]}`, or a `landmarks_file`"});
}

}  // namespace

void add_head_content(const CaseConfig& config, const Graph& graph, const std::vector<NodeResult>& results,
                      CaseManifest& manifest) {
  manifest.landmarks = config.landmarks;
  if (graph.landmarks >= 0)
    manifest.landmarks =
        std::get<std::shared_ptr<const HeadLandmarks>>(results[static_cast<std::size_t>(graph.landmarks)].data)
            ->landmarks;
  for (const SceneLandmark& wanted : config.scene_landmarks) require(wanted, manifest.landmarks);
  for (const auto& [landmark, anatomy] : config.roles.targets)
    if (const CaseLandmark* l = config.is_shown(anatomy.name) ? find(manifest.landmarks, landmark) : nullptr)
      manifest.targets.push_back({l->name, l->position_mm, l->confidence, anatomy.name});
  if (graph.anatomy_gate >= 0)
    for (const auto& figure : results[static_cast<std::size_t>(graph.anatomy_gate)].report.figures)
      manifest.figures.push_back(figure);
  if (const bool classed = std::any_of(manifest.figures.begin(), manifest.figures.end(),
                                       [](const auto& f) { return f.first == "class"; });
      classed && !config.roles.class_of.empty())
    manifest.figures.emplace_back("class_of", config.roles.class_of);
  if (graph.quality >= 0)
    for (const auto& figure : results[static_cast<std::size_t>(graph.quality)].report.figures)
      manifest.figures.emplace_back("scan." + figure.first, figure.second);
  if (graph.face_gate >= 0)
    for (const auto& figure : results[static_cast<std::size_t>(graph.face_gate)].report.figures)
      manifest.figures.emplace_back("face." + figure.first, figure.second);
  if (graph.deface >= 0)
    for (const auto& figure : results[static_cast<std::size_t>(graph.deface)].report.figures)
      manifest.figures.emplace_back("face." + figure.first, figure.second);
  manifest.face_policy = config.face.empty() ? "none" : config.face;
  manifest.face_reason = config.face_reason;
}

}  // namespace trephine
