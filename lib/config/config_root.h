// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace trephine::config {

/// The absolute path without links and dots; its end need not exist. Throws Error 66 where it cannot be followed: links
/// in a circle, a name that is too long, ".." after a folder that does not exist, a NUL.
std::filesystem::path absolute_path(const std::filesystem::path& p);

/// The folder that the configuration's paths may not leave: the nearest folder above the configuration that holds a
/// file trephine.root, else the configuration's own folder.
std::filesystem::path root_of(const std::filesystem::path& config);

/// Whether the path is the root or below it; both must come from absolute_path.
bool lies_in(const std::filesystem::path& path, const std::filesystem::path& root);

/// The path that `text` means in `folder`, as absolute_path gives it. Where it lies in none of the roots or cannot be
/// followed, the path is empty and `fault` says why.
std::filesystem::path path_in_roots(const std::filesystem::path& folder, const std::string& text,
                                    const std::vector<std::filesystem::path>& roots, std::string& fault);

}  // namespace trephine::config
