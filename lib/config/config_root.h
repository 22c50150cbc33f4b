// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

namespace trephine {

/// Absolute, without links and dots; the end need not be there.
std::filesystem::path absolute_path(const std::filesystem::path& p);

/// The nearest folder above the configuration that holds a file trephine.root, else the configuration's own: what its
/// paths may not leave.
std::filesystem::path root_of(const std::filesystem::path& config);

/// Whether the path is the root or below it; both as absolute_path gives them.
bool lies_in(const std::filesystem::path& path, const std::filesystem::path& root);

}  // namespace trephine
