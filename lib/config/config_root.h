// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

namespace trephine {

/// The absolute path without links and dots; its end need not exist.
std::filesystem::path absolute_path(const std::filesystem::path& p);

/// The folder that the configuration's paths may not leave: the nearest folder above the configuration that holds a
/// file trephine.root, else the configuration's own folder.
std::filesystem::path root_of(const std::filesystem::path& config);

/// Whether the path is the root or below it; both must come from absolute_path.
bool lies_in(const std::filesystem::path& path, const std::filesystem::path& root);

}  // namespace trephine
