// SPDX-License-Identifier: GPL-3.0-or-later
// The list of the formats, in the order in which help and reports name them. Each is declared beside its writer.
#include "base/error.h"
#include "meshio/export_format.h"

namespace trephine::meshio {

ExportFormat stl_format(), ply_format(), obj_format(), vtp_format(), vtk_format(), wrl_format(), x3d_format(),
    glb_format();

const std::vector<ExportFormat>& all_export_formats() {
  static const std::vector<ExportFormat> all = {stl_format(), ply_format(), obj_format(), vtp_format(),
                                                vtk_format(), wrl_format(), x3d_format(), glb_format()};
  return all;
}

const ExportFormat* find_export_format(std::string_view name) {
  for (const ExportFormat& format : all_export_formats())
    if (name == format.name) return &format;
  return nullptr;
}

const ExportFormat& export_format(std::string_view name) {
  if (const ExportFormat* format = find_export_format(name)) return *format;
  throw Error(ExitCode::internal, "", "export", "unknown format " + std::string(name));
}

std::string format_names(bool (*is_so)(const ExportFormat&), const std::string& word) {
  std::vector<std::string> names;
  for (const ExportFormat& format : all_export_formats())
    if (is_so(format)) names.emplace_back(format.name);
  std::string text;
  for (std::size_t n = 0; n < names.size(); ++n) {
    const bool last = n + 1 == names.size();
    text += (n == 0 ? "" : last ? " " + word + " " : ", ") + names[n];
  }
  return text;
}

}  // namespace trephine::meshio
