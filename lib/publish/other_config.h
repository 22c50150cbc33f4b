// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "config/config.h"

namespace trephine::publish {

/// The configurations in the folder of `file` that make a case of the same recipe without that anatomy, and show
/// something that `config` shows: what can be taken for a scan of which the anatomy is refused. Names, sorted.
std::vector<std::string> configs_without(const std::filesystem::path& file, const config::CaseConfig& config,
                                         const std::string& anatomy);

/// The refusal (code 80) of an anatomy by one of its own stages or of its surface, with these configurations at its
/// end; nothing where there are none, or for any other error.
std::optional<Error> with_other_configs(const Error& refusal, const std::filesystem::path& file,
                                        const config::CaseConfig& config);

}  // namespace trephine::publish
