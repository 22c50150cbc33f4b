// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cli/command.h"
#include "library/build.h"

namespace trephine::tools {

/// The arguments that say which library is built of what: config, --out, --case, --set, --phantom, --root.
std::vector<cli::Argument> library_arguments();
/// The request that they and LibraryBuildParams make.
library::LibraryBuildRequest library_request(const cli::ParsedCommand& parsed);

}  // namespace trephine::tools
