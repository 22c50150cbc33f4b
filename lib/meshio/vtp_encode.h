// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of meshio: the bytes of a .vtp file.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "surface/trimesh.h"

namespace trephine::meshio {

/// What an exported copy holds beside the mesh: a name and the unit (field data), a colour (point data RGB, the active
/// scalars), texture coordinates (one a point, or none).
struct VtpExtras {
  std::string name;
  std::optional<std::array<unsigned char, 3>> point_rgb;
  std::vector<std::array<double, 2>> texture;
};

/// What write_vtp writes, with its checksum. The mesh has passed check_mesh.
std::string encode_vtp(const surface::TriMesh& mesh, const VtpExtras& extras = {});

}  // namespace trephine::meshio
