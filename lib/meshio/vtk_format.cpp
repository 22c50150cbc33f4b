// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/format_text.h"

namespace trephine::meshio {
namespace {

// Legacy VTK, version 3.0, which every reader accepts. Most readers do not know version 5.1, which VTK 9 writes.
std::string encode_legacy_vtk(const PreparedSurface& s) {
  const PlainSurface p = plain_surface(s);
  const std::string count = std::to_string(p.world_mm.size());
  std::string out = "# vtk DataFile Version 3.0\ntrephine SPACE=LPS UNIT=mm " + s.source->name +
                    "\nASCII\nDATASET POLYDATA\nPOINTS " + count + " double\n";
  for (const Vec3 v : p.world_mm) {
    append_exact(out, v);
    out += '\n';
  }
  out += "POLYGONS " + std::to_string(p.triangles.size()) + " " + std::to_string(4 * p.triangles.size()) + "\n";
  for (const auto& t : p.triangles)
    out += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "\n";
  out += "POINT_DATA " + count + "\nSCALARS RGB unsigned_char 3\nLOOKUP_TABLE default\n";
  std::string colour;
  for (const unsigned char c : colour_bytes(s.source->colour_rgb)) colour += std::to_string(int(c)) + " ";
  colour.back() = '\n';
  for (std::size_t i = 0; i < p.world_mm.size(); ++i) out += colour;
  out += "NORMALS Normals float\n";
  for (const Vec3 n : p.normals) {
    append_short(out, n);
    out += '\n';
  }
  if (!p.texture.empty()) {
    out += "TEXTURE_COORDINATES TextureCoordinates 2 float\n";
    for (const auto& t : p.texture) {
      append_uv(out, t[0], t[1]);
      out += '\n';
    }
  }
  return out;
}

}  // namespace

// Legacy VTK, with a colour and a normal for each point.
ExportFormat vtk_format() {
  ExportFormat f;
  f.name = "vtk";
  f.help = "vtk (legacy)";
  f.texture = f.says_space = true;
  f.encode = [](const std::vector<PreparedSurface>& all, const std::string& stem) {
    return std::vector<ExportFile>{{stem + ".vtk", encode_legacy_vtk(all[0])}};
  };
  f.read_back.reader = {ForeignProgram::vtk, "vtk"};
  f.read_back.colour = true;
  return f;
}

}  // namespace trephine::meshio
