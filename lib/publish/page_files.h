// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "config/config.h"
#include "pipeline/executor.h"
#include "pipeline/graph.h"
#include "publish/case_content.h"
#include "stages/warning_kind.h"

namespace trephine::publish {

/// The page of a case that is about to be published, and what it is made of beside the case: view.html, view.json and
/// the deviation of every surface's points (page/page_notes.h), as files of the report folder. `warnings` are those of
/// the stages. The surfaces before decimation must be among the results (wanted_nodes). The same input gives the same
/// bytes.
std::vector<CasePicture> make_page_files(const config::CaseConfig& config, const pipeline::Graph& graph,
                                         const std::vector<pipeline::NodeResult>& results, const CaseContent& content,
                                         const std::vector<stages::GradedWarning>& warnings, const Progress& progress);

/// Whether a file of a case's report folder is one that a run leaves there, by its name: a picture, or the page's.
bool is_of_report(const std::filesystem::path& file);

}  // namespace trephine::publish
