// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of meshio: what the formats that are text have in common. Positions are written as the shortest decimals that
// read back as the same double, whatever the locale.
#include <array>
#include <string>
#include <vector>

#include "meshio/export_encode.h"

namespace trephine::meshio {

/// Six digits, which are enough for a direction, a texture or a colour.
std::string short_text(double v);
std::string rgb_text(const std::array<double, 3>& rgb);
/// Adds "x y z", so that it reads back as the same doubles, or in six digits.
void append_exact(std::string& out, Vec3 v);
void append_short(std::string& out, Vec3 v);
template <class Uv>
void append_uv(std::string& out, const Uv& u, const Uv& v) {
  out += short_text(u);
  out += ' ';
  out += short_text(v);
}
void append_texture_point(std::string& out, const TexturePoint& p);

/// The lights of a file that holds its own: from the patient's front, above and left, and a weaker one from behind and
/// the right, so that no side is black. A viewer's headlight is switched off beside them.
struct FileLight {
  double direction[3];  ///< in which it shines, LPS
  double intensity, ambient_intensity;
};
constexpr FileLight file_lights[] = {{{-0.4, 0.6, -0.7}, 0.8, 0.3}, {{0.5, -0.7, 0.3}, 0.4, 0}};
/// The picture that texture coordinates place on a surface: a fine grain in grey, which dims the surface's colour a
/// little. It is a square whose sides meet where it is repeated; `grain_repeats` times around and from pole to pole.
/// As the field `image` of a PixelTexture has it: "32 32 1 0xE6 ...".
std::string grain_image();
constexpr double grain_repeats[] = {16, 8};

/// A name that VRML and X3D allow for DEF.
std::string def_name(const std::string& name);

/// Adds each item by `one`, with the separator between two.
template <class Points, class Append>
void append_list(std::string& out, const Points& points, const char* separator, Append&& one) {
  bool first = true;
  for (const auto& p : points) {
    if (!first) out += separator;
    first = false;
    one(out, p);
  }
}
/// Adds "0 1 2 -1" for each triangle: the faces of an IndexedFaceSet.
void append_faces(std::string& out, const std::vector<std::array<std::uint32_t, 3>>& triangles, const char* separator);

}  // namespace trephine::meshio
