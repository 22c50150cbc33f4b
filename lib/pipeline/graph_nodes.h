// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of pipeline: nodes as stages and a case's configuration make them, not yet joined to others.
#include <string>

#include "pipeline/graph.h"

namespace trephine::pipeline {

/// A node with that name.
Node node_of(const stages::StageType& type, const std::string& name, AnyParams params);
/// The node of the stage that has these parameters. It bears the stage's name, after that of the anatomy or scan that
/// it is `of`, if any: "skull.boolean".
Node node_with(const AnyParams& params, const std::string& of = "");
/// The import of the case's series, or of the further scan of that name; `hash` is the one of its content.
Node import_node(const dicom::SeriesChoice& series, const std::string& hash, const std::string& scan = "");
/// The two below hash the files that the parameters name, and throw what that throws.
Node node_of_step(const config::RecipeStep& step, const std::string& name);
void add_file_hashes(Node& node);
/// "skull" of "skull.segment".
std::string anatomy_of(const std::string& source);

}  // namespace trephine::pipeline
