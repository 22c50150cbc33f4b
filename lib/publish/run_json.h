// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "pipeline/executor.h"
#include "publish/case_table.h"
#include "stages/warning_kind.h"

namespace trephine::publish {

/// The text of run.json: what differs between equal runs (times, peak memory of this process and its children, load,
/// threads), beside the report of each stage. It is not one of the case's checksummed files. `folder` describes what
/// else lay in the series' folder.
std::string run_json(const pipeline::Graph& graph, const std::vector<pipeline::NodeResult>& results,
                     const Report& folder, const std::vector<AnatomyResult>& anatomies,
                     const std::vector<stages::GradedWarning>& warnings, double wall_s);

}  // namespace trephine::publish
