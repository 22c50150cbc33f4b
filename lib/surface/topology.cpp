// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>

#include "surface/incidence.h"
#include "surface/trimesh.h"

namespace trephine {
namespace {

bool repeats(const std::array<std::uint32_t, 3>& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// How many fans (edge-connected groups) the triangles around p form.
int count_fans(const TriMesh& mesh, const Incidence& incidence, std::uint32_t p,
               std::vector<std::array<std::uint32_t, 2>>& ends, std::vector<std::uint32_t>& group) {
  ends.clear();
  for (std::uint32_t n = incidence.begin[p]; n < incidence.begin[p + 1]; ++n) {
    const auto& t = mesh.triangles[incidence.triangle[n]];
    if (repeats(t)) continue;
    const int c = t[0] == p ? 0 : t[1] == p ? 1 : 2;
    ends.push_back({t[(c + 1) % 3], t[(c + 2) % 3]});
  }
  group.resize(ends.size());
  for (std::uint32_t i = 0; i < group.size(); ++i) group[i] = i;
  int fans = static_cast<int>(ends.size());
  const auto find = [&](std::uint32_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  for (std::uint32_t i = 0; i < ends.size(); ++i)
    for (std::uint32_t j = 0; j < i; ++j) {
      if (ends[i][0] != ends[j][0] && ends[i][0] != ends[j][1] && ends[i][1] != ends[j][0] && ends[i][1] != ends[j][1])
        continue;
      const std::uint32_t a = find(i), b = find(j);
      if (a == b) continue;
      group[a] = b;
      --fans;
    }
  return fans;
}

std::size_t count_duplicates(const TriMesh& mesh, const Incidence& incidence) {
  std::size_t duplicates = 0;
  std::vector<std::array<std::uint32_t, 2>> others;
  for (std::uint32_t p = 0; p < mesh.points_mm.size(); ++p) {
    others.clear();
    for (std::uint32_t n = incidence.begin[p]; n < incidence.begin[p + 1]; ++n) {
      auto t = mesh.triangles[incidence.triangle[n]];
      std::sort(t.begin(), t.end());
      if (t[0] == p && !repeats(t)) others.push_back({t[1], t[2]});
    }
    std::sort(others.begin(), others.end());
    for (std::size_t i = 1; i < others.size(); ++i) duplicates += others[i] == others[i - 1];
  }
  return duplicates;
}

}  // namespace

Incidence::Incidence(const TriMesh& mesh) : begin(mesh.points_mm.size() + 1, 0), triangle(3 * mesh.triangles.size()) {
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) ++begin[v + 1];
  for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  std::vector<std::uint32_t> at(begin.begin(), begin.end() - 1);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) triangle[at[v]++] = t;
}

Topology topology_of(const TriMesh& mesh) {
  Topology r;
  r.points = mesh.points_mm.size();
  r.triangles = mesh.triangles.size();
  std::size_t faces = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!repeats(mesh.triangles[t])) ++faces;
    // The negation also counts an area that is not a number.
    if (repeats(mesh.triangles[t]) || !(norm(triangle_normal(mesh, t)) / 2 >= 1e-12)) ++r.degenerate_triangles;
  }
  const Incidence incidence(mesh);
  DisjointSets sets(mesh.triangles.size());
  for_each_edge(mesh, incidence, [&](std::uint32_t, auto from, auto to) {
    ++r.edges;
    if (to - from == 1) ++r.boundary_edges;
    if (to - from > 2) ++r.nonmanifold_edges;
    if (to - from == 2 && from->forward == (from + 1)->forward) ++r.misoriented_edges;
    for (auto use = from + 1; use != to; ++use) sets.unite(from->triangle, use->triangle);
  });
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    r.components += !repeats(mesh.triangles[t]) && sets.find(t) == t;

  std::vector<std::array<std::uint32_t, 2>> ends;
  std::vector<std::uint32_t> group;
  for (std::uint32_t p = 0; p < mesh.points_mm.size(); ++p) {
    const int fans = count_fans(mesh, incidence, p, ends, group);
    if (fans > 1) ++r.nonmanifold_points;
    if (fans == 0) ++r.unused_points;
  }
  r.duplicate_triangles = count_duplicates(mesh, incidence);
  r.euler_characteristic =
      static_cast<long>(r.points - r.unused_points) - static_cast<long>(r.edges) + static_cast<long>(faces);
  if (faces > 0 && r.closed() && r.manifold()) r.genus = r.components - r.euler_characteristic / 2;
  return r;
}

}  // namespace trephine
