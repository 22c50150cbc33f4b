// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/left_out.h"

namespace trephine {

std::string refused_anatomy(const CaseConfig& config, const Error& e) {
  if (e.code() != ExitCode::quality) return "";
  const std::string& field = e.field();
  for (const SceneAnatomy& a : config.scene) {
    if (!a.may_be_missing) continue;
    const std::string felt = "haptic." + a.name;  // as a shape: too thin for the voxels, or others take all of it
    const bool is_shape =
        field.size() >= felt.size() && field.compare(field.size() - felt.size(), felt.size(), felt) == 0;
    if (field == a.name || field.rfind(a.name + ".", 0) == 0 || is_shape) return a.name;
  }
  return "";
}

void keep_made(const Graph& graph, std::vector<NodeResult>& results, std::map<std::string, NodeResult>& known) {
  for (std::size_t i = 0; i < results.size(); ++i)
    if (results[i].state != NodeResult::State::not_needed) known[graph.nodes[i].key] = std::move(results[i]);
  results.clear();
}

}  // namespace trephine
