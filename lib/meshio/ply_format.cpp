// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/format_binary.h"

namespace trephine::meshio {
namespace {

// The names of the texture's properties are those that VTK, MeshLab and assimp all know.
std::string encode_ply(const PreparedSurface& s) {
  const PlainSurface p = plain_surface(s);
  std::string out = "ply\nformat binary_little_endian 1.0\ncomment trephine " + s.source->name +
                    "\ncomment SPACE=LPS\ncomment UNIT=mm\nelement vertex " + std::to_string(p.world_mm.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float "
                    "ny\nproperty float nz\n"
                    "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (!p.texture.empty()) out += "property float texture_u\nproperty float texture_v\n";
  out +=
      "element face " + std::to_string(p.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  out.reserve(out.size() + 35 * p.world_mm.size() + 13 * p.triangles.size());
  const auto colour = colour_bytes(s.source->colour_rgb);
  for (std::size_t i = 0; i < p.world_mm.size(); ++i) {
    append_binary(out, p.world_mm[i]);
    append_binary(out, p.normals[i]);
    for (const unsigned char c : colour) out.push_back(char(c));
    if (!p.texture.empty())
      for (const double t : p.texture[i]) append_binary(out, float(t));
  }
  for (const auto& t : p.triangles) {
    out.push_back(3);
    for (const std::uint32_t i : t) append_binary(out, std::int32_t(i));
  }
  return out;
}

}  // namespace

// PLY in little endian, with a colour and a normal for each point.
ExportFormat ply_format() {
  ExportFormat f;
  f.name = f.help = "ply";
  f.texture = f.says_space = true;
  f.precision = Precision::float32_world;
  f.encode = [](const std::vector<PreparedSurface>& all, const std::string& stem) {
    return std::vector<ExportFile>{{stem + ".ply", encode_ply(all[0])}};
  };
  f.read_back.reader = {ForeignProgram::assimp, "ply"};
  f.read_back.colour = true;
  return f;
}

}  // namespace trephine::meshio
