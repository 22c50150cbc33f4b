// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of meshio: what VTK and assimp do, in mesh_formats.so, which is loaded by the first call.
#include <string>
#include <string_view>
#include <vector>

#include "meshio/foreign.h"
#include "meshio/vtp_encode.h"
#include "surface/trimesh.h"

namespace trephine::meshio {

/// The library's functions. They throw as the functions of this room that are named alike.
struct Formats {
  void (*parse_vtp)(std::string* bytes, surface::TriMesh* mesh);
  void (*encode_vtp)(const surface::TriMesh* mesh, const VtpExtras* extras, std::string* bytes);
  void (*read_with_vtk)(const ForeignReader* reader, std::string_view bytes, std::vector<ForeignSurface>* surfaces);
  void (*read_with_assimp)(const ForeignReader* reader, std::string_view bytes, std::string_view companion,
                           std::vector<ForeignSurface>* surfaces);
};
/// Throws Error 70 where the library is missing.
const Formats& formats();

}  // namespace trephine::meshio
