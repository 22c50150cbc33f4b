// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "config/config.h"
#include "pipeline/executor.h"
#include "pipeline/graph.h"

namespace trephine::publish {

/// The anatomy of the scene that may be missing (`may_be_missing`) and whose stages, surface or haptic shape the error
/// refuses (80); empty where there is none.
std::string refused_anatomy(const config::CaseConfig& config, const Error& e);

/// Moves what a run has made to `known`, by key, for a run of another graph (ExecuteOptions::known).
void keep_made(const pipeline::Graph& graph, std::vector<pipeline::NodeResult>& results,
               std::map<std::string, pipeline::NodeResult>& known);

}  // namespace trephine::publish
