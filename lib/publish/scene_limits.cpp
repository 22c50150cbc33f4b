// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/scene_limits.h"

#include <fmt/format.h>

#include "base/log.h"
#include "base/params.h"
#include "base/refusal.h"
#include "meshing/decimate.h"
#include "meshing/normals.h"
#include "meshing/smooth.h"
#include "publish/head_content.h"

namespace trephine::publish {

namespace {

// With other limits decimation takes other steps, and may stop a little above or below what it stopped at.
std::int64_t roomy(std::int64_t triangles) { return (triangles * 5 / 4 + 999) / 1000 * 1000; }

void hold_triangles(const config::SceneAnatomy& limit, std::int64_t triangles, const std::string& stopped_by) {
  if (limit.max_triangles > 0 && triangles > limit.max_triangles)
    throw refusal(
        limit.name,
        std::to_string(triangles) + " triangles, the scene allows " + std::to_string(limit.max_triangles) +
            "; decimation stopped by " + stopped_by,
        {Message("raise `max_deviation_mm` of `decimate`, take a series of a smoother kernel, or allow more: ") +
         Setting{"max_triangles", std::to_string(roomy(triangles)), "scene.anatomies." + limit.name}})
        .finds_fault_with({limit.name})
        .because(Cause::too_many_triangles);
}

// The decimation of the anatomy where its published surface has the triangles of that: only smoothing and normals
// follow. Else -1.
int last_decimation(const pipeline::Graph& graph, const pipeline::Graph::Anatomy& anatomy) {
  const int decimation = graph.find_stage<meshing::DecimateParams>(anatomy.name);
  const int smoothing = graph.find_stage<meshing::SmoothParams>(anatomy.name);
  const int normals = graph.find_stage<meshing::NormalsParams>(anatomy.name);
  int node = anatomy.finished;
  while (node >= 0 && (node == smoothing || node == normals))
    node = graph.nodes[std::size_t(node)].sources.at("surface");
  return node == decimation ? decimation : -1;
}

}  // namespace

pipeline::Asked asked_of(const config::CaseConfig& config, const pipeline::Graph& graph) {
  pipeline::Asked asked;
  for (std::size_t a = 0; a < graph.anatomies.size(); ++a) {
    const config::SceneAnatomy& limit = config.scene[a];
    const int node = last_decimation(graph, graph.anatomies[a]);
    if (node < 0 || limit.max_triangles <= 0) continue;
    asked[node] = [&limit](const pipeline::NodeResult& made) {
      const auto* mesh = std::get_if<std::shared_ptr<const surface::TriMesh>>(&made.data);
      if (mesh && *mesh)
        hold_triangles(limit, std::int64_t((*mesh)->triangles.size()),
                       result_as<meshing::DecimateResult>(made.result).stopped_by);
    };
  }
  if (const int node = graph.result(stages::DataKind::landmarks); node >= 0 && !config.scene_landmarks.empty())
    asked[node] = [&config](const pipeline::NodeResult& made) {
      if (const auto* found = std::get_if<std::shared_ptr<const head::HeadLandmarks>>(&made.data); found && *found)
        require_landmarks(config, (*found)->landmarks);
    };
  return asked;
}

void hold_against_limits(const config::SceneAnatomy& limit, const AnatomyResult& result) {
  hold_triangles(limit, result.triangles_after, result.stopped_by);
  if (limit.max_deviation_mm > 0 && !(result.deviation_max_mm <= limit.max_deviation_mm))
    throw refusal(limit.name,
                  "deviates by " + to_text(result.deviation_max_mm) + " mm from its contour, the scene allows " +
                      to_text(limit.max_deviation_mm) + " mm",
                  {"lower `max_deviation_mm` of `decimate`, or raise `max_deviation_mm` in the scene"})
        .finds_fault_with({limit.name})
        .because(Cause::refused_output);
}

// Smoothing comes after decimation and moves the surface too, so that a bound set by hand for decimation alone is not
// the result's. A scene's bound is shared out between the two, and so is a trade's.
void tell_wider_than_asked(const config::CaseConfig& config, const config::RecipeAnatomy& recipe,
                           const config::SceneAnatomy& limit, double deviation_max_mm) {
  const auto* decimate = recipe.params_of<meshing::DecimateParams>();
  if (!decimate || !config.trade.rule.empty()) return;
  const double bound_mm = decimate->max_deviation_mm;
  const auto* smooth = recipe.params_of<meshing::SmoothParams>();
  const double smoothed_mm = smooth ? smooth->max_displacement_mm : 0;
  const bool of_scene = limit.max_deviation_mm > 0 && bound_mm + smoothed_mm >= limit.max_deviation_mm - 1e-9;
  if (bound_mm <= 0 || of_scene || deviation_max_mm <= bound_mm) return;
  log_warning(config.case_token + ": " + recipe.name + ": deviates by " + fmt::format("{:.3f}", deviation_max_mm) +
              " mm, though " + recipe.name + ".decimate.max_deviation_mm is " + to_text(bound_mm) +
              ": that bounds decimation alone; for a bound of the whole set scene.anatomies." + limit.name +
              ".max_deviation_mm = " + to_text(bound_mm) + " in its place");
}

void require_face_policy(const config::CaseConfig& config) {
  if (!config.face.empty()) return;
  std::string shown;
  for (const config::SceneAnatomy& wanted : config.scene)
    if (config.find_anatomy(wanted.name)->shows_face) shown = wanted.name;
  if (config.haptic.wanted && config.haptic.encoding() == voxel::HapticEncoding::hu) {
    for (const config::RecipeAnatomy& a : config.anatomies)
      if (a.shows_face) shown = "the haptic volume of raw HU";
  } else {
    for (const config::SceneShape& shape : config.haptic.shapes)
      if (config.find_anatomy(shape.name)->shows_face) shown = shape.name + " in the haptic volume";
  }
  if (config.ct)
    for (const config::RecipeAnatomy& a : config.anatomies)
      if (a.shows_face) shown = "the CT";
  if (!shown.empty())
    throw Error(ExitCode::privacy, "", "scene.face",
                shown +
                    " shows the patient's face; the scene must say face: {policy: deface}, {policy: crop} or "
                    "{policy: keep, reason: ...}");
}

}  // namespace trephine::publish
