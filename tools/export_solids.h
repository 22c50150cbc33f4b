// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "cli/command.h"
#include "export_parts.h"
#include "meshio/export_mesh.h"

namespace trephine::tools {

/// The formats for those who compute, which the command `export` takes beside those of meshio: volumes in tetrahedra,
/// and a model for robots' simulators.
struct SolidFormats {
  bool vtu = false, msh = false, sdf = false;
  bool tetra() const { return vtu || msh; }
  bool any() const { return tetra() || sdf; }
  /// Takes the name of one; false where it is none.
  bool take(const std::string& name);
};
const std::vector<std::string>& solid_format_names();
/// What they are, for the command's help.
extern const char* solid_formats_help;
/// Their parameters, by title.
std::vector<cli::ParameterGroup> solid_groups();

struct SolidExport {
  std::vector<meshio::ExportFile> files;  ///< in --out
  std::string folder;                     ///< of the model's, in --out
  std::vector<meshio::ExportFile> model;
  std::string table;
};
/// Of the case that `parsed` names, or else of the surfaces of the input; nothing is written. Throws as load_case,
/// fill_with_tetrahedra and sdf_model do.
SolidExport export_solids(const cli::ParsedCommand& parsed, const SolidFormats& formats, const ExportInput& input,
                          const std::string& stem, Report& report, const Progress& progress);
void write_solids(const std::filesystem::path& out, const SolidExport& made);

}  // namespace trephine::tools
