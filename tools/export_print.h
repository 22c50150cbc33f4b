// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "cli/command.h"
#include "meshio/export_mesh.h"

namespace trephine::tools {

/// The format `print` of the command `export`: parts of a case to be printed.
constexpr const char* print_format = "print";
extern const char* print_format_help;
cli::ParameterGroup print_group();

struct PrintExport {
  std::vector<meshio::ExportFile> files;  ///< in --out: an STL a part, all as 3MF, and what they are as JSON, last
  std::string table;
};
/// The parts of the case that `parsed` names; nothing is written. Where `name` is empty the files are named after the
/// case. Throws as print_head, encode_surfaces and verify_export do.
PrintExport export_print(const cli::ParsedCommand& parsed, const std::string& name, Report& report,
                         const Progress& progress);

}  // namespace trephine::tools
