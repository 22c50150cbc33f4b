// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of mesh_formats.so.
#include <string>
#include <string_view>
#include <vector>

#include "meshio/foreign.h"
#include "meshio/vtp_encode.h"
#include "surface/trimesh.h"

namespace trephine::meshio {

/// As parse_vtp, but the mesh has not passed check_mesh yet.
surface::TriMesh parse_with_vtk(std::string&& bytes);
/// As encode_vtp, without the checksum.
std::string encode_with_vtk(const surface::TriMesh& mesh, const VtpExtras& extras);
/// These two can crash or hang on damaged bytes. They throw Error 65.
std::vector<ForeignSurface> read_with_vtk(const ForeignReader& reader, std::string_view bytes);
std::vector<ForeignSurface> read_with_assimp(const ForeignReader& reader, std::string_view bytes,
                                             std::string_view companion);

}  // namespace trephine::meshio
