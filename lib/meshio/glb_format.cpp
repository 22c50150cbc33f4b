// SPDX-License-Identifier: GPL-3.0-or-later
// Binary glTF as the case package holds it (cases/glb.h): float32 mm about the mesh's origin_mm, and the matrix of a
// node that transforms them to metres with Y up.
#include "cases/glb.h"
#include "meshio/export_encode.h"
#include "meshio/export_format.h"

namespace trephine::meshio {
namespace {

std::string encode(const PreparedSurface& s) {
  cases::GlbParams params;
  params.center_mm = s.mesh().origin_mm;
  params.name = s.source->name;
  params.colour_rgb = s.source->colour_rgb;
  params.opacity = s.source->opacity;
  return cases::make_glb(s.mesh(), params);
}

}  // namespace

// Writes one surface, without texture coordinates, because the case package needs none.
ExportFormat glb_format() {
  ExportFormat f;
  f.name = f.help = "glb";
  f.metres_y_up = true;
  f.precision = Precision::float32_local;
  f.encode = [](const std::vector<PreparedSurface>& all, const std::string& stem) {
    return std::vector<ExportFile>{{stem + ".glb", encode(all[0])}};
  };
  f.read_back.reader = {ForeignProgram::assimp, "glb"};
  f.read_back.relative = 4 * float32_epsilon;
  f.read_back.colour = f.read_back.opacity = f.read_back.names = true;
  return f;
}

}  // namespace trephine::meshio
