// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "meshio/export_mesh.h"

namespace trephine::ambf {

/// The burrs that volumetric_drilling knows by these names: "1mm", ..., diameters.
constexpr std::array<int, 4> burrs_mm{1, 2, 4, 6};

/// OBJ files in mm: a burr of each diameter with a shaft along +x, as the plugin's own drills lie, its ball's middle at
/// 0; and mark.obj, a ball of that diameter.
std::vector<meshio::ExportFile> tool_meshes(double mark_diameter_mm);

}  // namespace trephine::ambf
