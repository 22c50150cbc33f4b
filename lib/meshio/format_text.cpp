// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/format_text.h"

#include <cmath>

#include "base/text.h"

namespace trephine::meshio {

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

std::string rgb_text(const std::array<double, 3>& rgb) {
  return short_text(rgb[0]) + ' ' + short_text(rgb[1]) + ' ' + short_text(rgb[2]);
}

void append_texture_point(std::string& out, const TexturePoint& p) { append_uv(out, p.u, p.v); }

std::string grain_image() {
  constexpr int side = 32;
  constexpr unsigned darkest = 200;
  std::string out = std::to_string(side) + " " + std::to_string(side) + " 1";
  std::uint32_t state = 1;  // any numbers do, and the same ones in each file
  for (int n = 0; n < side * side; ++n) {
    state = state * 1664525u + 1013904223u;
    const unsigned grey = darkest + (state >> 24) % (256 - darkest);
    constexpr char digits[] = "0123456789ABCDEF";
    out += n % side == 0 ? "\n0x" : " 0x";
    out += digits[grey >> 4];
    out += digits[grey & 15];
  }
  return out;
}

std::string def_name(const std::string& name) {
  std::string out = name;
  for (char& c : out)
    if (c == '.' || c == '-') c = '_';
  return out[0] >= '0' && out[0] <= '9' ? "_" + out : out;
}

void append_faces(std::string& out, const std::vector<std::array<std::uint32_t, 3>>& triangles, const char* separator) {
  append_list(out, triangles, separator, [](std::string& o, const std::array<std::uint32_t, 3>& t) {
    for (const std::uint32_t i : t) {
      o += std::to_string(i);
      o += ' ';
    }
    o += "-1";
  });
}

}  // namespace trephine::meshio
