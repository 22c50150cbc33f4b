// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "cases/case.h"
#include "config/config.h"
#include "pipeline/executor.h"
#include "pipeline/graph.h"

namespace trephine::publish {

/// Adds landmarks (found and given) and, as targets, those that lie in an anatomy. Throws Error 80 where a landmark
/// that the scene needs was not found or has less confidence than the scene demands, naming how to give it.
void add_landmarks(const config::CaseConfig& config, const pipeline::Graph& graph,
                   const std::vector<pipeline::NodeResult>& results, cases::CaseManifest& manifest);

/// Adds the figures of the patient, of checks and of changes. The volumes of anatomies are those of the manifest's
/// surfaces. The class is uncertain where a sure finding of the manifest concerns the anatomy that the case is classed
/// by.
void add_figures(const config::CaseConfig& config, const std::vector<stages::CaseParts>& parts,
                 cases::CaseManifest& manifest);

/// That Error 80 alone.
void require_landmarks(const config::CaseConfig& config, const std::vector<cases::CaseLandmark>& known);

}  // namespace trephine::publish
