// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <vector>

namespace trephine::library {

/// Scans that were dropped on the desk's page lie in this folder beside LIBRARY.yaml, each under a name of 16
/// hexadecimal digits, and before all of it is there, under one that begins with the prefix.
constexpr const char* dropped_folder = "dropped";
constexpr const char* incoming_prefix = ".incoming-";

/// Those that no case of LIBRARY.yaml has as its series and no configuration beside it names, and that are older than
/// so many seconds: copies of patients' data that nobody uses. Throws what read_library_config throws: where it is not
/// known what is used, nothing is unused.
std::vector<std::filesystem::path> unused_drops(const std::filesystem::path& library_file,
                                                const std::vector<std::filesystem::path>& roots, double older_than_s);

}  // namespace trephine::library
