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
