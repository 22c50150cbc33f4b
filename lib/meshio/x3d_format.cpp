// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/format_text.h"

namespace trephine::meshio {
namespace {

std::string texture_of() {
  return "\n<PixelTexture image=\"" + grain_image() + "\"/>\n<TextureTransform scale=\"" +
         short_text(grain_repeats[0]) + " " + short_text(grain_repeats[1]) + "\"/>";
}

std::string encode_x3d(const std::vector<PreparedSurface>& all) {
  std::string out =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- trephine SPACE=LPS UNIT=mm -->\n"
      "<X3D profile=\"Interchange\" version=\"3.3\">\n<head>\n<unit category=\"length\" name=\"millimetre\" "
      "conversionFactor=\"0.001\"/>\n<meta name=\"SPACE\" content=\"LPS\"/>\n<meta name=\"UNIT\" content=\"mm\"/>\n"
      "</head>\n<Scene>\n<NavigationInfo headlight=\"false\"/>\n";
  for (const FileLight& l : file_lights)
    out += "<DirectionalLight direction=\"" + rgb_text({l.direction[0], l.direction[1], l.direction[2]}) +
           "\" intensity=\"" + short_text(l.intensity) + "\" ambientIntensity=\"" + short_text(l.ambient_intensity) +
           "\"/>\n";
  for (const PreparedSurface& s : all) {
    out += "<Transform DEF=\"" + def_name(s.source->name) + "\">\n<Shape>\n<Appearance><Material diffuseColor=\"" +
           rgb_text(s.source->colour_rgb) + "\" transparency=\"" + short_text(1 - s.source->opacity) + "\"/>" +
           (s.textured() ? texture_of() : "") +
           "</Appearance>\n<IndexedFaceSet solid=\"true\" ccw=\"true\" normalPerVertex=\"true\" coordIndex=\"";
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
