// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace trephine::commands {

/// Runs a recording through the case again, after those `before` it, and publishes the case as it is at the recording's
/// end in the folder `out`: the same files, but the haptic volume, and the name with "-drilled". Returns that name.
/// Throws Error 65 where the recording is of another case or cut nothing, 80 where the replay gives other voxels than
/// the recording says; 73 and 74.
std::string write_drilled_case(const std::filesystem::path& case_folder, const std::filesystem::path& recording,
                               const std::filesystem::path& out, const std::vector<std::filesystem::path>& before = {});

}  // namespace trephine::commands
