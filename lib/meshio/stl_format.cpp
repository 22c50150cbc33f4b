// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.h"
#include "meshio/format_binary.h"

namespace trephine::meshio {
namespace {

std::string encode_stl(const PreparedSurface& s) {
  const auto& triangles = s.mesh().triangles;
  // A header that begins with "solid" is taken for the text form.
  std::string out = "trephine STL SPACE=LPS UNIT=mm " + s.source->name;
  out.resize(80, ' ');
  if (triangles.size() > 0xffffffffu) throw Error(ExitCode::internal, "", s.source->name, "too many triangles for STL");
  out.reserve(84 + 50 * triangles.size());
  append_binary(out, std::uint32_t(triangles.size()));
  for (const auto& t : triangles) {
    const Vec3 a = s.world_mm[t[0]], b = s.world_mm[t[1]], c = s.world_mm[t[2]];
    append_binary(out, normalized(cross(b - a, c - a)));
    append_binary(out, a);
    append_binary(out, b);
    append_binary(out, c);
    append_binary(out, std::uint16_t{0});
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

}  // namespace trephine::meshio
