// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "library/engine.h"
#include "phantom/phantom.h"

namespace trephine::library {

/// A synthetic patient that the library makes before its cases.
struct LibraryPhantom {
  std::string name;
  phantom::PhantomParams params;
};

/// One case that LIBRARY.yaml lists, or that was found.
struct LibraryCase {
  std::string token;             ///< for a found series empty: its token is derived from the series' content
  std::string suffix;            ///< such as "-drilled" where the library makes several cases of a patient; else empty
  std::filesystem::path series;  ///< empty: the series that the configuration names, or that of the phantom
  int phantom = -1;              ///< index of its patient in LibraryConfig::phantoms; -1: a real series
  std::filesystem::path config;  ///< configuration of the case: recipe and scene
  std::filesystem::path landmarks;
  std::vector<std::string>
      set;  ///< path=value, from the library, then the case, then the command line: the last one wins
  std::map<std::string, std::string> set_in_file;  ///< by path, where the file has it: "library.yaml:5:64"
  std::string config_at, series_at;  ///< where the file names them: "library.yaml:5:30"; empty: it names none there
  std::string origin;  ///< "series[0] folder 3": its name in messages while it has no token; never a folder's name
};

struct LibraryConfig {
  std::filesystem::path file;
  std::vector<std::filesystem::path> roots;  ///< folders of --root
  std::vector<LibraryPhantom> phantoms;
  std::vector<LibraryCase> cases;  ///< listed cases, then found ones (by name of their folder), then those of phantoms
  EngineParams engine;
};

struct LibraryOverrides {
  std::vector<std::string> set;      ///< for every case
  std::vector<std::string> phantom;  ///< "columns_count=256", for every phantom
  std::vector<std::filesystem::path> roots;
};

/// Reads LIBRARY.yaml; docs/how-to/library.md says what it holds. Paths are relative to it and may not leave its root,
/// as for a case's configuration. The cases' own configurations are not read yet. Throws ErrorList with every fault at
/// once: 78 with file:line:column, 64 for an override; 66 where the file or a folder is missing.
LibraryConfig read_library_config(const std::filesystem::path& file, const LibraryOverrides& overrides = {});

/// What LIBRARY.yaml may hold, for its schema.
AnyParams library_file_params();

}  // namespace trephine::library
