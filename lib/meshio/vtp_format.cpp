// SPDX-License-Identifier: GPL-3.0-or-later
// VTK's XML PolyData as the tools write it (meshio/vtp.h), with a name, a colour and texture coordinates.
#include "meshio/export_encode.h"
#include "meshio/export_format.h"
#include "meshio/vtp_encode.h"

namespace trephine::meshio {
namespace {

std::string encode(const PreparedSurface& s) {
  VtpExtras extras;
  extras.name = s.source->name;
  extras.point_rgb = colour_bytes(s.source->colour_rgb);
  surface::TriMesh copy;
  copy.origin_mm = s.mesh().origin_mm;
  if (!s.textured()) {
    copy = s.mesh();
    copy.normals = s.normals;
  } else {
    copy.triangles = s.texture.triangles;
    for (const TexturePoint& p : s.texture.points) {
      copy.points_mm.push_back(s.mesh().points_mm[p.point]);
      copy.normals.push_back(s.normals[p.point]);
      extras.texture.push_back({p.u, p.v});
    }
  }
  return encode_vtp(copy, extras);
}

}  // namespace

// Coordinates are doubles; each point has a colour and a normal.
ExportFormat vtp_format() {
  ExportFormat f;
  f.name = f.help = "vtp";
  f.texture = f.says_space = true;
  f.encode = [](const std::vector<PreparedSurface>& all, const std::string& stem) {
    return std::vector<ExportFile>{{stem + ".vtp", encode(all[0])}};
  };
  f.read_back.reader = {ForeignProgram::vtk, "vtp"};
  f.read_back.colour = true;
  return f;
}

}  // namespace trephine::meshio
