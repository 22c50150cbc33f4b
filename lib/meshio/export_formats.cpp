// SPDX-License-Identifier: GPL-3.0-or-later
// How formats are found. Each is declared beside its writer, in NAME_format.cpp, and CMake makes the list of them.
#include "base/error.h"
#include "base/joined.h"
#include "meshio/export_format.h"

namespace trephine::meshio {

const ExportFormat* find_export_format(std::string_view name) {
  for (const ExportFormat& format : format_types())
    if (name == format.name) return &format;
  return nullptr;
}

const ExportFormat& export_format(std::string_view name) {
  if (const ExportFormat* format = find_export_format(name)) return *format;
  throw Error(ExitCode::internal, "", "export", "unknown format " + std::string(name));
}

std::string format_names(bool (*is_so)(const ExportFormat&), const std::string& word) {
  std::vector<std::string> names;
  for (const ExportFormat& format : format_types())
    if (is_so(format)) names.emplace_back(format.name);
  return listed(names, word);
}

}  // namespace trephine::meshio
