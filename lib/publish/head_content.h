// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "cases/case.h"
#include "config/config.h"
#include "pipeline/executor.h"
#include "pipeline/graph.h"

namespace trephine::publish {

/// Adds what a case says of the head as a whole: landmarks (found and given), the foramina of Monro as targets, the
/// figures of the anatomical consistency check, and the face policy. Throws Error 80 where a landmark that the scene
/// needs was not found or has less confidence than the scene demands, naming how to give it.
void add_head_content(const config::CaseConfig& config, const pipeline::Graph& graph,
                      const std::vector<pipeline::NodeResult>& results, cases::CaseManifest& manifest);

/// That Error 80 alone.
void require_landmarks(const config::CaseConfig& config, const std::vector<cases::CaseLandmark>& known);

}  // namespace trephine::publish
