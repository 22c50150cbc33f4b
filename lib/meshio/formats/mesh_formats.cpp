// SPDX-License-Identifier: GPL-3.0-or-later
// What mesh_formats.so gives the programs (meshio/formats.h).
#include "base/shared_library.h"
#include "meshio/formats/formats_inside.h"

#define GIVEN extern "C" __attribute__((visibility("default")))

namespace trephine::meshio {

GIVEN int trephine_mesh_version() { return own_library_version; }

GIVEN void trephine_mesh_parse_vtp(std::string* bytes, surface::TriMesh* mesh) {
  *mesh = parse_with_vtk(std::move(*bytes));
}

GIVEN void trephine_mesh_encode_vtp(const surface::TriMesh* mesh, const VtpExtras* extras, std::string* bytes) {
  *bytes = encode_with_vtk(*mesh, *extras);
}

GIVEN void trephine_mesh_read_with_vtk(const ForeignReader* reader, std::string_view bytes,
                                       std::vector<ForeignSurface>* surfaces) {
  *surfaces = read_with_vtk(*reader, bytes);
}

GIVEN void trephine_mesh_read_with_assimp(const ForeignReader* reader, std::string_view bytes,
                                          std::string_view companion, std::vector<ForeignSurface>* surfaces) {
  *surfaces = read_with_assimp(*reader, bytes, companion);
}

}  // namespace trephine::meshio
