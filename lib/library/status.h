// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "library/build.h"
#include "library/library_state.h"

namespace trephine::library {

struct LibraryStatus {
  int running = 0, waiting = 0, built = 0, failed = 0;  ///< jobs of the open batches
  int lost = 0;         ///< neither in Slurm nor ended: the next look submits them again
  int stale = 0;        ///< cases that a build would build and that no batch has
  bool answers = true;  ///< Slurm's controller
  std::string table, json;
};

/// What a cluster does of a library, and how its cases' last builds ended. With a configuration also which cases are
/// stale, which reads what a dry run of `library build` reads. Changes nothing. Throws Error 66 where there is no
/// library, and what make_plan throws.
LibraryStatus status_of_library(const std::filesystem::path& library,
                                const std::optional<LibraryBuildRequest>& configured);

}  // namespace trephine::library
