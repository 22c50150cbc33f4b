// SPDX-License-Identifier: GPL-3.0-or-later
#include "tetra/program/filled.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/disjoint_sets.h"

namespace trephine::tetra {
namespace {

using Face = std::array<std::uint32_t, 3>;

constexpr std::size_t lone = 8;  // fewer tetrahedra than that

// The faces of a tetrahedron, outwards.
constexpr std::array<std::array<std::size_t, 3>, 4> faces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

struct Beside {
  Face face;  // ascending
  std::uint32_t cell;
  std::uint8_t number;
};

// Every face of every cell, those of the same corners one after the other.
std::vector<Beside> all_faces(const Filled& filled) {
  std::vector<Beside> all;
  all.reserve(4 * filled.tetrahedra.size());
  for (std::uint32_t c = 0; c < filled.tetrahedra.size(); ++c)
    for (std::uint8_t f = 0; f < 4; ++f) {
      Face face{};
      for (std::size_t n = 0; n < 3; ++n) face[n] = filled.tetrahedra[c][faces[f][n]];
      std::sort(face.begin(), face.end());
      all.push_back({face, c, f});
    }
  std::sort(all.begin(), all.end(),
            [](const Beside& a, const Beside& b) { return std::tie(a.face, a.cell) < std::tie(b.face, b.cell); });
  return all;
}

}  // namespace

Filled in_order(const Filled& found) {
  std::vector<std::uint32_t> order(found.points.size()), number(found.points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 &p = found.points[a], &q = found.points[b];
    return std::tie(p.z, p.y, p.x) < std::tie(q.z, q.y, q.x);
  });
  Filled out;
  for (std::uint32_t n = 0; n < order.size(); ++n) {
    number[order[n]] = n;
    out.points.push_back(found.points[order[n]]);
  }
  std::vector<std::pair<std::array<std::uint32_t, 4>, std::uint8_t>> cells;
  for (std::size_t n = 0; n < found.tetrahedra.size(); ++n) {
    std::array<std::uint32_t, 4> t = found.tetrahedra[n];
    for (std::uint32_t& c : t) c = number[c];
    // Even permutations alone: two exchanges bring the least corner to the front, a rotation the least of the rest.
    const std::size_t least = std::size_t(std::min_element(t.begin(), t.end()) - t.begin());
    if (least > 0) {
      std::swap(t[0], t[least]);
      std::swap(t[least == 1 ? 2 : 1], t[least == 3 ? 2 : 3]);
    }
    std::rotate(t.begin() + 1, std::min_element(t.begin() + 1, t.end()), t.end());
    cells.emplace_back(t, found.region_of[n]);
  }
  std::sort(cells.begin(), cells.end());
  for (const auto& [t, region] : cells) {
    out.tetrahedra.push_back(t);
    out.region_of.push_back(region);
  }
  return out;
}

std::uint64_t join_lone_cells(Filled& filled) {
  const std::vector<Beside> all = all_faces(filled);
  DisjointSets pieces(filled.tetrahedra.size());
  for (std::size_t n = 0; n + 1 < all.size(); ++n)
    if (all[n].face == all[n + 1].face && filled.region_of[all[n].cell] == filled.region_of[all[n + 1].cell])
      pieces.unite(all[n].cell, all[n + 1].cell);
  std::map<std::size_t, std::size_t> size_of;  // by what stands for a piece
  std::map<std::uint8_t, std::size_t> largest;
  for (std::uint32_t c = 0; c < filled.tetrahedra.size(); ++c) ++size_of[pieces.find(c)];
  for (const auto& [root, size] : size_of)
    largest[filled.region_of[root]] = std::max(largest[filled.region_of[root]], size);
  const auto is_lone = [&](std::uint32_t cell) {
    const std::size_t size = size_of.at(pieces.find(cell));
    return size < lone && size < largest.at(filled.region_of[cell]);
  };
  std::map<std::size_t, std::map<std::uint8_t, std::size_t>> shared;  // of a lone piece, by region how many faces
  for (std::size_t n = 0; n + 1 < all.size(); ++n) {
    if (all[n].face != all[n + 1].face) continue;
    const std::uint32_t a = all[n].cell, b = all[n + 1].cell;
    if (filled.region_of[a] == filled.region_of[b]) continue;
    if (is_lone(a)) ++shared[pieces.find(a)][filled.region_of[b]];
    if (is_lone(b)) ++shared[pieces.find(b)][filled.region_of[a]];
  }
  std::uint64_t joined = 0;
  std::vector<std::uint8_t> region = filled.region_of;
  for (std::uint32_t c = 0; c < filled.tetrahedra.size(); ++c)
    if (const auto found = shared.find(pieces.find(c)); found != shared.end()) {
      region[c] = std::max_element(found->second.begin(), found->second.end(), [](const auto& x, const auto& y) {
                    return x.second < y.second;
                  })->first;
      ++joined;
    }
  filled.region_of = std::move(region);
  return joined;
}

void add_borders(Filled& filled) {
  const std::vector<Beside> all = all_faces(filled);
  for (std::size_t n = 0; n < all.size(); ++n) {
    const bool shared = n + 1 < all.size() && all[n].face == all[n + 1].face;
    const Beside *own = &all[n], *other = shared ? &all[n + 1] : nullptr;
    n += shared;
    const std::uint8_t beyond = other ? filled.region_of[other->cell] : 0;
    if (beyond == filled.region_of[own->cell]) continue;
    // It lies on the surface of the smaller one, which comes first; 0, outside, comes last.
    if (beyond != 0 && beyond < filled.region_of[own->cell]) std::swap(own, other);
    Face face{};
    for (std::size_t c = 0; c < 3; ++c) face[c] = filled.tetrahedra[own->cell][faces[own->number][c]];
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    filled.borders.push_back(face);
    filled.between.push_back({filled.region_of[own->cell], other ? filled.region_of[other->cell] : std::uint8_t(0)});
  }
}

}  // namespace trephine::tetra
