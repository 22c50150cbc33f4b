// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/format_text.h"

namespace trephine::meshio {
namespace {

std::string texture_of() {
  return "\n  texture PixelTexture { image " + grain_image() + " }\n  textureTransform TextureTransform { scale " +
         short_text(grain_repeats[0]) + " " + short_text(grain_repeats[1]) + " }";
}

// The texture has no index of its own, because VTK's importer loses every point of a shape that has such an index and
// normals.
std::string encode_vrml(const std::vector<PreparedSurface>& all) {
  std::string out = "#VRML V2.0 utf8\n# trephine SPACE=LPS UNIT=mm\nNavigationInfo { headlight FALSE }\n";
  for (const FileLight& l : file_lights)
    out += "DirectionalLight { direction " + rgb_text({l.direction[0], l.direction[1], l.direction[2]}) +
           " intensity " + short_text(l.intensity) + " ambientIntensity " + short_text(l.ambient_intensity) + " }\n";
  for (const PreparedSurface& s : all) {
    const PlainSurface p = plain_surface(s);
    out += "DEF " + def_name(s.source->name) + " Shape {\n appearance Appearance { material Material { diffuseColor " +
           rgb_text(s.source->colour_rgb) + " transparency " + short_text(1 - s.source->opacity) + " }" +
           (p.texture.empty() ? "" : texture_of()) +
           " }\n geometry IndexedFaceSet {\n  solid TRUE\n  ccw TRUE\n  normalPerVertex TRUE\n"
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

}  // namespace

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

}  // namespace trephine::meshio
