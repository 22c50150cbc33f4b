// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

namespace trephine::scene {

/// A picture of the renderer: 8-bit sRGB, row by row from the top, three bytes a pixel.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

}  // namespace trephine::scene
