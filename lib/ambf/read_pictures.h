// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "base/progress.h"

namespace trephine::ambf {

/// The pixels of PNG files of one size, as RGBA of 8 bits, handed over in their order; decoded in a bounded child, some
/// files at a time. Throws Error 65 with the file where one is no PNG or has another size, 66 where it is missing; 70
/// where the child dies or reaches a limit. What `take` throws is passed on.
void read_pictures(const std::vector<std::filesystem::path>& files, int width, int height,
                   const std::function<void(std::size_t file, const std::uint8_t* pixels)>& take,
                   const Progress& progress = {});

}  // namespace trephine::ambf
