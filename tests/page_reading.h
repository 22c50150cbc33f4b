// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "grid/grid.h"
#include "grid/nrrd_header.h"
#include "surface/trimesh.h"

/// A case's page read back from its HTML by docs/reference/case-page.md, with no code of the room that writes it.
namespace page_reading {

using namespace trephine;
using Json = nlohmann::json;

/// The text of the script element with that id.
inline std::string element(const std::string& html, const std::string& id) {
  const std::size_t at = html.find("id=\"" + id + "\">");
  if (at == std::string::npos) throw std::runtime_error("no element " + id);
  const std::size_t from = html.find('>', at) + 1;
  return html.substr(from, html.find("</script>", from) - from);
}

inline std::string from_base64(const std::string& text) {
  static const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  unsigned bits = 0, count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::size_t v = letters.find(c);
    if (v == std::string::npos) throw std::runtime_error("not base64");
    bits = bits << 6 | unsigned(v);
    if ((count += 6) >= 8) out += char(bits >> (count -= 8) & 0xff);
  }
  return out;
}

struct Surface {
  std::string name;
  surface::TriMesh mesh;  ///< origin 0: world positions
  std::vector<double> deviation_mm;
  std::vector<bool> known;
};

struct Page {
  Json data;
  std::vector<Surface> surfaces;
  std::string html;
  std::string block(const std::string& id) const {
    std::string out(data.at("blocks").at(id).get<std::size_t>(), '\0');
    grid::detail::gzip_expand(from_base64(element(html, id)), out.data(), out.size());
    return out;
  }
  grid::Lattice lattice(const char* id) const {
    grid::Lattice l;
    for (int k = 0; k < 3; ++k) {
      l.size[k] = data.at(id).at("size")[k];
      l.spacing_mm[k] = data.at(id).at("spacing_mm")[k];
      l.origin_mm[k] = data.at(id).at("origin_mm")[k];
    }
    return l;
  }
  /// Adds to each byte the median of left, above, and left + above - above left.
  static void undo_prediction(std::string& bytes, const grid::Lattice& l) {
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const auto at = [&](int x, int y) {
            return x < 0 || y < 0 ? 0 : int(static_cast<unsigned char>(bytes.at(l.index(x, y, k))));
          };
          std::array<int, 3> three{at(i - 1, j), at(i, j - 1), at(i - 1, j) + at(i, j - 1) - at(i - 1, j - 1)};
          std::sort(three.begin(), three.end());
          bytes[l.index(i, j, k)] = static_cast<char>(bytes[l.index(i, j, k)] + three[1]);
        }
  }
  /// The HU of the CT's levels.
  grid::Grid<std::int16_t> ct() const {
    grid::Grid<std::int16_t> grid(lattice("ct"));
    std::string bytes = block(data.at("ct").at("block"));
    const Json& levels = data.at("ct").at("levels");
    if (data.at("ct").at("predicted").get<bool>()) undo_prediction(bytes, grid);
    for (std::size_t i = 0; i < grid.voxels.size(); ++i) {
      const int level = static_cast<unsigned char>(bytes.at(i));
      for (std::size_t s = 1; s < levels.size(); ++s) {
        const double l0 = levels[s - 1][0], l1 = levels[s][0], h0 = levels[s - 1][1], h1 = levels[s][1];
        if (level >= l0 && level <= l1)
          grid.voxels[i] = std::int16_t(std::lround(h0 + (h1 - h0) * (level - l0) / (l1 - l0)));
      }
    }
    return grid;
  }
};

inline Surface read_surface(const Json& a, const std::string& bytes) {
  std::size_t at = 0;
  const auto varint = [&] {
    std::uint64_t v = 0;
    for (int shift = 0;; shift += 7) {
      const auto b = static_cast<unsigned char>(bytes.at(at++));
      v |= std::uint64_t(b & 127) << shift;
      if (b < 128) return v;
    }
  };
  Surface s;
  s.name = a.at("name");
  const std::size_t points = a.at("points"), triangles = a.at("triangles");
  std::uint64_t next = 0;
  for (std::size_t t = 0; t < triangles; ++t) {
    std::array<std::uint32_t, 3> corner{};
    for (auto& c : corner) {
      const std::uint64_t back = varint();
      c = std::uint32_t(next - back);
      next += back == 0;
    }
    s.mesh.triangles.push_back(corner);
  }
  if (next != points) throw std::runtime_error("points");
  std::array<std::int64_t, 3> q{0, 0, 0};
  for (std::size_t p = 0; p < points; ++p) {
    Vec3 world;
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t v = varint();
      q[k] += v % 2 ? -std::int64_t(v / 2) - 1 : std::int64_t(v / 2);
      world[k] = a.at("min_mm")[k].get<double>() + double(q[k]) / 65535 * a.at("size_mm")[k].get<double>();
    }
    s.mesh.points_mm.push_back(world);
  }
  if (a.contains("deviation_scale_mm"))
    for (std::size_t p = 0; p < points; ++p) {
      const int level = static_cast<signed char>(bytes.at(at++));
      s.known.push_back(level != -128);
      s.deviation_mm.push_back(level * a.at("deviation_scale_mm").get<double>() / 127);
    }
  if (at != bytes.size()) throw std::runtime_error("bytes are left");
  return s;
}

inline Page read_page(const std::string& html) {
  Page page;
  page.html = html;
  page.data = Json::parse(element(html, "case-data"));
  for (const Json& a : page.data.at("anatomies"))
    if (a.contains("block")) page.surfaces.push_back(read_surface(a, page.block(a.at("block"))));
  return page;
}

}  // namespace page_reading
