// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of meshio: VTK's reader behind a plain function.
#include <string>

#include "surface/trimesh.h"

namespace trephine::meshio {

constexpr const char* vtp_local_name = "local_points_mm";
constexpr const char* vtp_origin_name = "origin_mm";
constexpr const char* vtp_space_name = "SPACE";

/// The bytes of a .vtp file as a mesh that has passed check_mesh. Throws Error 65 without a file name. VTK 9.1's reader
/// can crash on damaged bytes, so it is called in this process only for bytes whose checksum was verified.
surface::TriMesh parse_vtp(std::string&& bytes);

}  // namespace trephine::meshio
