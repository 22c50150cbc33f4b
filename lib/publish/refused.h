// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "config/config.h"
#include "pipeline/executor.h"
#include "pipeline/graph.h"
#include "stages/warning_kind.h"

namespace trephine::publish {

/// What a refused run leaves for a person to look at: LIBRARY/CASE.refused/, a folder that only its owner may open,
/// with message.txt (the refusal and the warnings) and pictures (PNG) of what had been made. It is no case: the
/// library, the page and the simulator never open it. A later run of the case replaces it, one that is published
/// removes it, and so does `library gc`.
std::filesystem::path refused_folder(const std::filesystem::path& library, const std::string& case_token);

struct RefusedRun {
  const config::CaseConfig& config;
  const pipeline::Graph& graph;
  const std::vector<pipeline::NodeResult>&
      made;                           ///< what was in memory when the run ended; empty, or one for each node
  const pipeline::StageCache& cache;  ///< where the rest may be
  const std::vector<stages::GradedWarning>& warnings;
};

/// Writes the folder, whole or not at all. To be called under the case's lock. After a refusal for privacy (81) it
/// holds the message alone. Where the scene takes the face away (crop, deface) and the face gate had not passed yet,
/// there are pictures only of surfaces that show no face, and none of the scan. The message holds no path, for paths
/// may name patients. Where nothing was made anew because the refusal was in the cache, the pictures of the run that
/// made it stay. `refusal` as it was thrown, which may hold a picture; `told` as it is told. Returns whether the folder
/// holds a picture. Throws Error 73, 74.
bool keep_refused(const std::filesystem::path& folder, const RefusedRun& run, const Error& refusal, const Error& told);

/// Removes the folder and what a killed run left of one.
void remove_refused(const std::filesystem::path& folder);

}  // namespace trephine::publish
