// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/formats.h"

#include "base/shared_library.h"

namespace trephine::meshio {

const Formats& formats() {
  static const Formats loaded = [] {
    const SharedLibrary library = own_library("mesh_formats", "trephine_mesh_");
    Formats f{};
    library.find("parse_vtp", f.parse_vtp);
    library.find("encode_vtp", f.encode_vtp);
    library.find("read_with_vtk", f.read_with_vtk);
    library.find("read_with_assimp", f.read_with_assimp);
    return f;
  }();
  return loaded;
}

}  // namespace trephine::meshio
