// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "haptics/tool.h"

namespace trephine::scene {

/// A vertex as the renderer takes it: mm, a unit normal, and the surface's colour (sRGB).
struct SolidVertex {
  float position_mm[3], normal[3], colour_rgb[3];
};
struct Solid {
  std::vector<SolidVertex> vertices;
  std::vector<std::uint32_t> indices;  ///< three a triangle, counter-clockwise from outside
};

/// The tool as it is shown: the part that is felt as it is felt, and behind it a handle, a syringe or a screw's driver.
/// In the tool's coordinates: the tip at 0, the tail towards +z. A catheter has a mark at every cm from its tip, longer
/// ones at 5 and 10 cm. Each part closed and outwards. `inside_rgb`: of what is in a syringe.
Solid solid_of(const haptics::ToolParams& own_tool, const std::optional<std::array<float, 3>>& inside_rgb = {});
/// Where that ends, from the tip: of a tube, where what flows through it drips.
double tail_mm(const haptics::ToolParams& own_tool);
/// Of the veins; of the arteries, and in the beat of the heart; CSF; and the froth of air in a syringe.
constexpr std::array<float, 3> venous_rgb{0.42f, 0.03f, 0.04f}, arterial_rgb{0.72f, 0.04f, 0.05f},
    arterial_beat_rgb{0.90f, 0.08f, 0.08f}, csf_rgb{0.80f, 0.90f, 0.97f}, air_rgb{0.93f, 0.95f, 0.97f};
/// A ball about 0.
Solid ball_solid(double radius_mm, std::array<float, 3> colour_rgb, int rings = 12);

}  // namespace trephine::scene
