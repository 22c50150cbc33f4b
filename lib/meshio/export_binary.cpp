// SPDX-License-Identifier: GPL-3.0-or-later
// STL and PLY, both in binary, little endian.
#include <cstring>

#include "base/error.h"
#include "meshio/export_encode.h"

namespace trephine::meshio {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "floats and integers are written as they lie in memory");

template <class T>
void append(std::string& out, T v) {
  char bytes[sizeof v];
  std::memcpy(bytes, &v, sizeof v);
  out.append(bytes, sizeof v);
}

void append(std::string& out, Vec3 v) {
  for (int c = 0; c < 3; ++c) append(out, float(v[c]) + 0.f);
}

std::string encode_stl(const PreparedSurface& s) {
  const auto& triangles = s.mesh().triangles;
  // A header that begins with "solid" is taken for the text form.
  std::string out = "trephine STL SPACE=LPS UNIT=mm " + s.source->name;
  out.resize(80, ' ');
  if (triangles.size() > 0xffffffffu) throw Error(ExitCode::internal, "", s.source->name, "too many triangles for STL");
  out.reserve(84 + 50 * triangles.size());
  append(out, std::uint32_t(triangles.size()));
  for (const auto& t : triangles) {
    const Vec3 a = s.world_mm[t[0]], b = s.world_mm[t[1]], c = s.world_mm[t[2]];
    append(out, normalized(cross(b - a, c - a)));
    append(out, a);
    append(out, b);
    append(out, c);
    append(out, std::uint16_t{0});
  }
  return out;
}

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
    append(out, p.world_mm[i]);
    append(out, p.normals[i]);
    for (const unsigned char c : colour) out.push_back(char(c));
    if (!p.texture.empty())
      for (const double t : p.texture[i]) append(out, float(t));
  }
  for (const auto& t : p.triangles) {
    out.push_back(3);
    for (const std::uint32_t i : t) append(out, std::int32_t(i));
  }
  return out;
}

}  // namespace

// STL: the normals are those of the facets, and there is no colour.
ExportFormat stl_format() {
  ExportFormat f;
  f.name = "stl";
  f.help = "stl (binary)";
  f.says_space = true;
  f.precision = Precision::float32_world;
  f.encode = [](const std::vector<PreparedSurface>& all, const std::string& stem) {
    return std::vector<ExportFile>{{stem + ".stl", encode_stl(all[0])}};
  };
  f.read_back.reader = {ForeignProgram::assimp, "stl"};
  return f;
}

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
