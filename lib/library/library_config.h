// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "phantom/phantom.h"

namespace trephine {

/// A synthetic patient that the library makes itself before its cases.
struct LibraryPhantom {
  std::string name;
  phantom::PhantomParams params;
};

/// One case as LIBRARY.yaml lists or finds it.
struct LibraryCase {
  std::string token;             ///< of a found series empty: it comes from the series' content
  std::string suffix;            ///< "-drilled" where the library makes several cases of a patient; else empty
  std::filesystem::path series;  ///< empty: the one that the configuration names, or the phantom's
  int phantom = -1;              ///< its patient among LibraryConfig::phantoms; -1: a real series
  std::filesystem::path config;  ///< of the case: recipe and scene
  std::filesystem::path landmarks;
  std::vector<std::string> set;  ///< path=value; library, then case, then command line: the last one wins
  std::string origin;  ///< "series[0] folder 3": what messages call it while it has no token; no name of a folder
};

struct LibraryConfig {
  std::filesystem::path file;
  std::vector<std::filesystem::path> roots;  ///< --root
  std::vector<LibraryPhantom> phantoms;
  std::vector<LibraryCase> cases;  ///< listed, then found (by name of their folder), then the phantoms'
};

struct LibraryOverrides {
  std::vector<std::string> set;      ///< for every case
  std::vector<std::string> phantom;  ///< "columns_count=256", for every phantom
  std::vector<std::filesystem::path> roots;
};

/// Reads LIBRARY.yaml; docs/library.md says what it holds. Paths are relative to it and bound to its root as a case's
/// are to the case configuration's. Of the cases' own configurations nothing is read yet. Throws ErrorList with every
/// fault at once: 78 with file:line:column, 64 for an override; 66 where the file or a folder is missing.
LibraryConfig read_library_config(const std::filesystem::path& file, const LibraryOverrides& overrides = {});

/// What LIBRARY.yaml may say, for its schema.
AnyParams library_file_params();

}  // namespace trephine
