// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/format_text.h"

namespace trephine::meshio {
namespace {

std::string encode_obj(const std::vector<PreparedSurface>& all, const std::string& material_file) {
  std::string out = "# trephine SPACE=LPS UNIT=mm\nmtllib " + material_file + "\n";
  std::size_t points = 1, textures = 1;  // OBJ counts from 1, through the whole file
  for (const PreparedSurface& s : all) {
    out += "g " + s.source->name + "\nusemtl " + s.source->name + "\n";
    for (const Vec3 p : s.world_mm) {
      out += "v ";
      append_exact(out, p);
      out += '\n';
    }
    for (const TexturePoint& p : s.texture.points) {
      out += "vt ";
      append_texture_point(out, p);
      out += '\n';
    }
    for (const Vec3 n : s.normals) {
      out += "vn ";
      append_short(out, n);
      out += '\n';
    }
    for (std::size_t t = 0; t < s.mesh().triangles.size(); ++t) {
      out += 'f';
      for (int c = 0; c < 3; ++c) {
        const std::string p = std::to_string(points + s.mesh().triangles[t][c]);
        out += ' ' + p + '/';
        if (s.textured()) out += std::to_string(textures + s.texture.triangles[t][c]);
        out += '/' + p;
      }
      out += '\n';
    }
    points += s.world_mm.size();
    textures += s.texture.points.size();
  }
  return out;
}

std::string encode_mtl(const std::vector<PreparedSurface>& all) {
  std::string out = "# trephine\n";
  for (const PreparedSurface& s : all)
    out += "newmtl " + s.source->name + "\nKa 0 0 0\nKd " + rgb_text(s.source->colour_rgb) +
           "\nKs 0.1 0.1 0.1\nNs 10\nd " + short_text(s.source->opacity) + "\nillum 2\n";
  return out;
}

}  // namespace

// OBJ: a surface is a group; its colour and opacity are a material in the .mtl file beside it.
ExportFormat obj_format() {
  ExportFormat f;
  f.name = "obj";
  f.help = "obj with its .mtl";
  f.several = f.texture = f.says_space = true;
  f.encode = [](const std::vector<PreparedSurface>& all, const std::string& stem) {
    const std::string materials = stem + ".mtl";
    return std::vector<ExportFile>{{materials, encode_mtl(all)}, {stem + ".obj", encode_obj(all, materials)}};
  };
  f.read_back.reader = {ForeignProgram::assimp, "obj"};
  f.read_back.relative = 2 * float32_epsilon;
  f.read_back.colour = f.read_back.opacity = f.read_back.names = true;
  return f;
}

}  // namespace trephine::meshio
