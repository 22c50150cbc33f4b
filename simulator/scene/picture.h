// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace trephine::scene {

/// Where the key light comes from, in the viewer's axes.
constexpr std::array<float, 3> key_light{-0.45f, 0.62f, 0.64f};

/// A picture of the renderer: 8-bit sRGB, row by row from the top, three bytes a pixel.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

}  // namespace trephine::scene
