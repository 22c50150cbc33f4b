// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "dicom/import.h"
#include "library/library_config.h"
#include "pipeline/graph.h"

namespace trephine::library {

/// Everything except the series that a case's bytes depend on, as text by name: effective parameters of the stages that
/// the scene needs ("skull.decimate.max_deviation_mm"), versions of these stages ("stage skull.decimate"), other
/// content of the configuration's files ("scene.anatomies.skin.max_triangles"; comments and layout do not count),
/// landmarks, and the program.
struct CaseSettings {
  std::map<std::string, std::string> values;
  std::string sha256;            ///< hash of the settings
  std::filesystem::path series;  ///< the series that the configuration names; may be empty
  dicom::ImportParams import;
};

/// Reads a case's configuration. `hash_of_scan` as in make_graph. Throws what read_case_config and make_graph throw.
CaseSettings read_case_settings(const LibraryCase& one, const std::vector<std::filesystem::path>& roots, bool pictures,
                                const std::string& program_version, const pipeline::HashOfScan& hash_of_scan = {});

/// Writes the settings as a JSON object, and reads it back (throws Error 65).
std::string settings_json(const CaseSettings& settings);
std::map<std::string, std::string> parse_settings_json(std::string_view json);

/// The differences, one on each line: "skull.decimate.max_deviation_mm: 0.2, was 0.3".
std::vector<std::string> explain_difference(const std::map<std::string, std::string>& before,
                                            const std::map<std::string, std::string>& now);

}  // namespace trephine::library
