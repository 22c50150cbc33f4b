// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <list>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "cases/case.h"
#include "cli/command.h"
#include "meshio/export_mesh.h"
#include "meshio/label_map.h"

namespace trephine::tools {

/// What the parts of the command `export` share.

/// Reads "a,b", given once or more.
std::vector<std::string> items_of(const cli::ParsedCommand& parsed, const std::string& argument);

/// Throw Error 64: a wrong use of a flag; a name that is none of those known; a name that cannot be a file's.
[[noreturn]] void export_usage(const std::string& field, const std::string& what);
[[noreturn]] void unknown_name(const std::string& field, const std::string& name,
                               const std::vector<std::string>& known);
void check_export_name(const std::string& field, const std::string& name);

/// What is exported. The meshes stay where they are.
struct ExportInput {
  std::list<surface::TriMesh> meshes;
  std::vector<meshio::ExportSurface> surfaces;
  cases::CaseManifest manifest;  ///< for a case
};

/// The shapes of --labels as one map; colours are the case's, where there is one.
Outcome<meshio::LabelMap, meshio::LabelMapResult> label_map_of(const cli::ParsedCommand& parsed,
                                                               const cases::CaseManifest& manifest,
                                                               const Progress& progress);

}  // namespace trephine::tools
