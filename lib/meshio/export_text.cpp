// SPDX-License-Identifier: GPL-3.0-or-later
// The formats that are text: OBJ with its materials, legacy VTK, VRML 2.0 and X3D. Positions are written as the
// shortest decimals that read back as the same double, whatever the locale.
#include <cmath>

#include "base/text.h"
#include "meshio/export_encode.h"

namespace trephine::meshio {
namespace {

// Six digits are enough for a direction, a texture or a colour.
std::string short_text(double v) { return to_text(std::round(v * 1e6) / 1e6 + 0.0); }

void append_exact(std::string& out, Vec3 v) {
  out += to_text(v.x);
  out += ' ';
  out += to_text(v.y);
  out += ' ';
  out += to_text(v.z);
}

void append_short(std::string& out, Vec3 v) {
  out += short_text(v.x);
  out += ' ';
  out += short_text(v.y);
  out += ' ';
  out += short_text(v.z);
}

template <class Uv>
void append_uv(std::string& out, const Uv& u, const Uv& v) {
  out += short_text(u);
  out += ' ';
  out += short_text(v);
}

std::string rgb_text(const std::array<double, 3>& rgb) {
  return short_text(rgb[0]) + ' ' + short_text(rgb[1]) + ' ' + short_text(rgb[2]);
}

// Makes a name that VRML and X3D allow for DEF.
std::string def_name(const std::string& name) {
  std::string out = name;
  for (char& c : out)
    if (c == '.' || c == '-') c = '_';
  return out[0] >= '0' && out[0] <= '9' ? "_" + out : out;
}

template <class Points, class Append>
void append_list(std::string& out, const Points& points, const char* separator, Append&& one) {
  bool first = true;
  for (const auto& p : points) {
    if (!first) out += separator;
    first = false;
    one(out, p);
  }
}

// "0 1 2 -1": the faces of an IndexedFaceSet.
void append_faces(std::string& out, const std::vector<std::array<std::uint32_t, 3>>& triangles, const char* separator) {
  append_list(out, triangles, separator, [](std::string& o, const std::array<std::uint32_t, 3>& t) {
    for (const std::uint32_t i : t) {
      o += std::to_string(i);
      o += ' ';
    }
    o += "-1";
  });
}

void append_texture_point(std::string& out, const TexturePoint& p) { append_uv(out, p.u, p.v); }

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

// The texture has no index of its own, because VTK's importer loses every point of a shape that has such an index and
// normals.
std::string encode_vrml(const std::vector<PreparedSurface>& all) {
  std::string out = "#VRML V2.0 utf8\n# trephine SPACE=LPS UNIT=mm\n";
  for (const PreparedSurface& s : all) {
    const PlainSurface p = plain_surface(s);
    out += "DEF " + def_name(s.source->name) + " Shape {\n appearance Appearance { material Material { diffuseColor " +
           rgb_text(s.source->colour_rgb) + " transparency " + short_text(1 - s.source->opacity) +
           " } }\n geometry IndexedFaceSet {\n  solid TRUE\n  ccw TRUE\n  normalPerVertex TRUE\n"
           "  coord Coordinate { point [\n";
    append_list(out, p.world_mm, ",\n", append_exact);
    out += " ] }\n  coordIndex [\n";
    append_faces(out, p.triangles, "\n");
    out += " ]\n  normal Normal { vector [\n";
    append_list(out, p.normals, ",\n", append_short);
    out += " ] }\n";
    if (!p.texture.empty()) {
      out += "  texCoord TextureCoordinate { point [\n";
      append_list(out, p.texture, ",\n",
                  [](std::string& o, const std::array<double, 2>& t) { append_uv(o, t[0], t[1]); });
      out += " ] }\n";
    }
    out += " }\n}\n";
  }
  return out;
}

std::string encode_x3d(const std::vector<PreparedSurface>& all) {
  std::string out =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- trephine SPACE=LPS UNIT=mm -->\n"
      "<X3D profile=\"Interchange\" version=\"3.3\">\n<head>\n<unit category=\"length\" name=\"millimetre\" "
      "conversionFactor=\"0.001\"/>\n<meta name=\"SPACE\" content=\"LPS\"/>\n<meta name=\"UNIT\" content=\"mm\"/>\n"
      "</head>\n<Scene>\n";
  for (const PreparedSurface& s : all) {
    out += "<Transform DEF=\"" + def_name(s.source->name) + "\">\n<Shape>\n<Appearance><Material diffuseColor=\"" +
           rgb_text(s.source->colour_rgb) + "\" transparency=\"" + short_text(1 - s.source->opacity) +
           "\"/></Appearance>\n<IndexedFaceSet solid=\"true\" ccw=\"true\" normalPerVertex=\"true\" coordIndex=\"";
    append_faces(out, s.mesh().triangles, "\n");
    if (s.textured()) {
      out += "\" texCoordIndex=\"";
      append_faces(out, s.texture.triangles, "\n");
    }
    out += "\">\n<Coordinate point=\"";
    append_list(out, s.world_mm, "\n", append_exact);
    out += "\"/>\n<Normal vector=\"";
    append_list(out, s.normals, "\n", append_short);
    out += "\"/>\n";
    if (s.textured()) {
      out += "<TextureCoordinate point=\"";
      append_list(out, s.texture.points, "\n", append_texture_point);
      out += "\"/>\n";
    }
    out += "</IndexedFaceSet>\n</Shape>\n</Transform>\n";
  }
  return out + "</Scene>\n</X3D>\n";
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

// VRML: a surface is a shape with a material.
ExportFormat wrl_format() {
  ExportFormat f;
  f.name = "wrl";
  f.help = "wrl (VRML 2.0)";
  f.several = f.texture = true;
  f.encode = [](const std::vector<PreparedSurface>& all, const std::string& stem) {
    return std::vector<ExportFile>{{stem + ".wrl", encode_vrml(all)}};
  };
  f.read_back.reader = {ForeignProgram::vtk, "wrl"};
  f.read_back.relative = 2 * float32_epsilon;
  f.read_back.colour = f.read_back.opacity = true;
  return f;
}

// X3D version 3.3 in XML: a surface is a shape with a material, and its name is that of the node around it.
ExportFormat x3d_format() {
  ExportFormat f;
  f.name = f.help = "x3d";
  f.several = f.texture = true;
  f.encode = [](const std::vector<PreparedSurface>& all, const std::string& stem) {
    return std::vector<ExportFile>{{stem + ".x3d", encode_x3d(all)}};
  };
  f.read_back.reader = {ForeignProgram::assimp, "x3d"};
  f.read_back.relative = 2 * float32_epsilon;
  f.read_back.colour = f.read_back.opacity = true;
  return f;
}

}  // namespace trephine::meshio
