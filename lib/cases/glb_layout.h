// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>

namespace trephine::cases::detail {

/// The node's matrix, column by column: LPS millimetres about the centre to metres, Y up, +Z forward.
constexpr std::array<double, 16> gltf_from_lps = {0.001, 0, 0, 0, 0, 0, -0.001, 0, 0, 0.001, 0, 0, 0, 0, 0, 1};

/// 65535 is the index that glTF keeps for restarting a strip.
constexpr std::size_t largest_uint16_points = 65535;

constexpr int gltf_uint16 = 5123, gltf_uint32 = 5125, gltf_float = 5126, gltf_triangles = 4;

}  // namespace trephine::cases::detail
