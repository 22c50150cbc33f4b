// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "cases/load_case.h"
#include "cli/command.h"
#include "meshio/export_mesh.h"
#include "meshio/markups.h"

namespace trephine::tools {

/// The formats of a whole case, which the command `export` takes beside those of surfaces, labels and DICOM.
struct SceneFormats {
  bool slicer_mrb = false, ambf = false;
  bool any() const { return slicer_mrb || ambf; }
  /// Takes the name of one; false where it is none.
  bool take(const std::string& name);
};
const std::vector<std::string>& scene_format_names();
/// What they are, for the command's help.
extern const char* scene_formats_help;

struct SceneExport {
  std::vector<meshio::ExportFile> files;    ///< in the output folder
  std::string ambf_folder;                  ///< of the next; may be empty
  std::vector<meshio::ExportFile> of_ambf;  ///< with the names of their folders in it
  std::string table;                        ///< a line for each scene
};
/// The scenes of the case that `parsed` names; nothing is written. Where `name` is empty they have the case's. Throws
/// as load_case, encode_surfaces and encode_adf do; 65 where the case shows nothing.
SceneExport export_scenes(const cli::ParsedCommand& parsed, const SceneFormats& formats, const std::string& name,
                          Report& report, const Progress& progress);
/// Writes them; pictures of an earlier, longer stack are removed.
void write_scenes(const std::filesystem::path& out, const SceneExport& made);

}  // namespace trephine::tools
