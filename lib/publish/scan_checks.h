// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "pipeline/executor.h"
#include "pipeline/graph.h"

namespace trephine::publish {

/// The names of the further scans that the graph's stages read.
std::vector<std::string> names_of_scans(const pipeline::Graph& graph);

/// A scan of another patient must not become part of the case: compares what each of these scans says of the patient
/// (dicom/identity.h) with what the CT and the other scans say. Returns a warning for each of which it is not sure;
/// names and IDs themselves go nowhere. Throws Error 65, field scans.NAME, where two contradict each other and the
/// configuration does not say why; what compare_patients throws. Also of a
/// scan whose given transform moves nothing, that it has the CT's frame of reference: Error 65 where it has another.
std::vector<std::string> require_one_patient(const config::CaseConfig& config, const std::vector<std::string>& scans,
                                             const Progress& progress);

/// A series that says what it is must be what the configuration says. The results are those of the graph's nodes.
/// Throws Error 65.
void require_modalities(const config::CaseConfig& config, const pipeline::Graph& graph,
                        const std::vector<pipeline::NodeResult>& results);

}  // namespace trephine::publish
