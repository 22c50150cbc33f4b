// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/left_out.h"

namespace trephine::publish {

std::string refused_anatomy(const config::CaseConfig& config, const Error& e) {
  if (e.code() != ExitCode::quality) return "";
  const std::string& field = e.field();
  for (const config::SceneAnatomy& a : config.scene) {
    if (!a.may_be_missing) continue;
    const std::string felt = "haptic." + a.name;  // as a shape: too thin for the voxels, or others take all of it
    const bool is_shape =
        field.size() >= felt.size() && field.compare(field.size() - felt.size(), felt.size(), felt) == 0;
    if (field == a.name || field.rfind(a.name + ".", 0) == 0 || is_shape) return a.name;
  }
  return "";
}

void keep_made(const pipeline::Graph& graph, std::vector<pipeline::NodeResult>& results,
               std::map<std::string, pipeline::NodeResult>& known) {
  for (std::size_t i = 0; i < results.size(); ++i)
    if (results[i].state != pipeline::NodeResult::State::not_needed) known[graph.nodes[i].key] = std::move(results[i]);
  results.clear();
}

}  // namespace trephine::publish
