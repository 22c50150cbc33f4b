// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

#include "meshio/format_text.h"
#include "meshio/zip_bundle.h"

namespace trephine::meshio {
namespace {

constexpr const char* content_types =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\n"
    "<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\n"
    "<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\n"
    "</Types>\n";
constexpr const char* relations =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\n"
    "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\n"
    "</Relationships>\n";

std::string hex_colour(const ExportSurface& s) {
  const auto rgb = colour_bytes(s.colour_rgb);
  char text[16];
  std::snprintf(text, sizeof text, "#%02X%02X%02X%02X", rgb[0], rgb[1], rgb[2], unsigned(std::lround(255 * s.opacity)));
  return text;
}

// Attributes of a vertex from "x y z".
std::string vertex(Vec3 p) {
  std::string all;
  append_exact(all, p);
  const std::size_t one = all.find(' '), two = all.find(' ', one + 1);
  return "<vertex x=\"" + all.substr(0, one) + "\" y=\"" + all.substr(one + 1, two - one - 1) + "\" z=\"" +
         all.substr(two + 1) + "\"/>\n";
}

std::string encode_model(const std::vector<PreparedSurface>& all, const std::string& title) {
  std::string out =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<model unit=\"millimeter\" xml:lang=\"en-US\" "
      "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
      "<metadata name=\"Title\">" +
      title +
      "</metadata>\n<metadata name=\"Application\">trephine</metadata>\n"
      "<metadata name=\"Description\">SPACE=LPS UNIT=mm</metadata>\n<resources>\n<basematerials id=\"1\">\n";
  for (const PreparedSurface& s : all)
    out += "<base name=\"" + s.source->name + "\" displaycolor=\"" + hex_colour(*s.source) + "\"/>\n";
  out += "</basematerials>\n";
  for (std::size_t n = 0; n < all.size(); ++n) {
    out += "<object id=\"" + std::to_string(n + 2) + "\" type=\"model\" name=\"" + all[n].source->name +
           "\" pid=\"1\" pindex=\"" + std::to_string(n) + "\">\n<mesh>\n<vertices>\n";
    for (const Vec3& p : all[n].world_mm) out += vertex(p);
    out += "</vertices>\n<triangles>\n";
    for (const auto& t : all[n].mesh().triangles)
      out += "<triangle v1=\"" + std::to_string(t[0]) + "\" v2=\"" + std::to_string(t[1]) + "\" v3=\"" +
             std::to_string(t[2]) + "\"/>\n";
    out += "</triangles>\n</mesh>\n</object>\n";
  }
  out += "</resources>\n<build>\n";
  for (std::size_t n = 0; n < all.size(); ++n) out += "<item objectid=\"" + std::to_string(n + 2) + "\"/>\n";
  return out + "</build>\n</model>\n";
}

}  // namespace

// 3MF, for printers: a ZIP with one model; a surface is an object with its name and a base material of its colour.
ExportFormat threemf_format() {
  ExportFormat f;
  f.name = f.help = "3mf";
  f.several = true;
  f.encode = [](const std::vector<PreparedSurface>& all, const std::string& stem) {
    const std::vector<ExportFile> parts{{"[Content_Types].xml", content_types},
                                        {"_rels/.rels", relations},
                                        {"3D/3dmodel.model", encode_model(all, stem)}};
    return std::vector<ExportFile>{{stem + ".3mf", bundle_of("", parts)}};
  };
  f.read_back.reader = {ForeignProgram::assimp, "3mf"};
  f.read_back.relative = 2 * float32_epsilon;
  f.read_back.colour = true;  // assimp gives the number of an object for its name
  return f;
}

}  // namespace trephine::meshio
