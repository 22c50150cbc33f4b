// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "surface/incidence.h"
#include "surface/trimesh.h"

namespace trephine::surface {
namespace {

bool repeats(const std::array<std::uint32_t, 3>& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// Buffers that are reused from point to point.
struct Around {
  std::vector<std::array<std::uint32_t, 2>> ends;  ///< the far edges of a point's triangles
  std::vector<std::uint32_t> group;
};

void find_ends(const TriMesh& mesh, const Incidence& incidence, std::uint32_t p, Around& around) {
  around.ends.clear();
  for (std::uint32_t n = incidence.begin[p]; n < incidence.begin[p + 1]; ++n) {
    const auto& t = mesh.triangles[incidence.triangle[n]];
    if (repeats(t)) continue;
    const int c = t[0] == p ? 0 : t[1] == p ? 1 : 2;
    around.ends.push_back({t[(c + 1) % 3], t[(c + 2) % 3]});
  }
}

int count_fans(Around& around) {
  auto& ends = around.ends;
  auto& group = around.group;
  group.resize(ends.size());
  for (std::uint32_t i = 0; i < group.size(); ++i) group[i] = i;
  int fans = static_cast<int>(ends.size());
  const auto find = [&](std::uint32_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  constexpr std::size_t few = 64;
  if (ends.size() > few) {
    // Those that share a far point, found by sorting: a soup may hang a million triangles on one point.
    std::vector<std::array<std::uint32_t, 2>> by_end;
    by_end.reserve(2 * ends.size());
    for (std::uint32_t i = 0; i < ends.size(); ++i)
      for (const std::uint32_t end : ends[i]) by_end.push_back({end, i});
    std::sort(by_end.begin(), by_end.end());
    for (std::size_t n = 1; n < by_end.size(); ++n) {
      if (by_end[n][0] != by_end[n - 1][0]) continue;
      const std::uint32_t a = find(by_end[n][1]), b = find(by_end[n - 1][1]);
      if (a == b) continue;
      group[a] = b;
      --fans;
    }
    return fans;
  }
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

/// Counts the triangles around p that have the same points as another one, where p is the lowest of these points.
std::size_t count_duplicates(Around& around, std::uint32_t p) {
  auto& ends = around.ends;
  std::size_t kept = 0, duplicates = 0;
  for (auto e : ends) {
    if (e[0] > e[1]) std::swap(e[0], e[1]);
    if (e[0] > p) ends[kept++] = e;
  }
  ends.resize(kept);
  std::sort(ends.begin(), ends.end());
  for (std::size_t i = 1; i < ends.size(); ++i) duplicates += ends[i] == ends[i - 1];
  return duplicates;
}

/// What the points in [from, to) and their edges add to the counts.
Topology counts_at(const TriMesh& mesh, const Incidence& incidence, std::uint32_t from, std::uint32_t to) {
  Topology r;
  for_each_edge(mesh, incidence, from, to, [&](std::uint32_t, auto first, auto end) {
    ++r.edges;
    if (end - first == 1) ++r.boundary_edges;
    if (end - first > 2) ++r.nonmanifold_edges;
    if (end - first == 2 && first->forward == (first + 1)->forward) ++r.misoriented_edges;
  });
  Around around;
  for (std::uint32_t p = from; p < to; ++p) {
    find_ends(mesh, incidence, p, around);
    const int fans = count_fans(around);
    if (fans > 1) ++r.nonmanifold_points;
    if (fans == 0) ++r.unused_points;
    r.duplicate_triangles += count_duplicates(around, p);
  }
  return r;
}

/// Counts the pieces that are connected by edges. Where no single point connects two fans, the pieces connected by
/// points are the same, and they are found faster.
int count_components(const TriMesh& mesh, const Incidence& incidence, bool by_points) {
  int components = 0;
  if (by_points) {
    DisjointSets sets(mesh.points_mm.size());
    for (const auto& t : mesh.triangles) {
      if (repeats(t)) continue;
      sets.unite(t[0], t[1]);
      sets.unite(t[1], t[2]);
    }
    for (std::uint32_t p = 0; p < mesh.points_mm.size(); ++p) {
      if (sets.find(p) != p) continue;
      for (std::uint32_t n = incidence.begin[p]; n < incidence.begin[p + 1]; ++n)
        if (!repeats(mesh.triangles[incidence.triangle[n]])) {
          ++components;
          break;
        }
    }
    return components;
  }
  DisjointSets sets(mesh.triangles.size());
  for_each_edge(mesh, incidence, [&](std::uint32_t, auto from, auto to) {
    for (auto use = from + 1; use != to; ++use) sets.unite(from->triangle, use->triangle);
  });
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    components += !repeats(mesh.triangles[t]) && sets.find(t) == t;
  return components;
}

}  // namespace

int count_fans(const TriMesh& mesh, const Incidence& incidence, std::uint32_t point) {
  Around around;
  find_ends(mesh, incidence, point, around);
  return count_fans(around);
}

Incidence::Incidence(const TriMesh& mesh) : begin(mesh.points_mm.size() + 1, 0), triangle(3 * mesh.triangles.size()) {
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) ++begin[v + 1];
  for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  std::vector<std::uint32_t> at(begin.begin(), begin.end() - 1);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) triangle[at[v]++] = t;
}

Topology topology_of(const TriMesh& mesh) { return topology_of(mesh, Incidence(mesh)); }

Topology topology_of(const TriMesh& mesh, const Incidence& incidence) {
  Topology r;
  r.points = mesh.points_mm.size();
  r.triangles = mesh.triangles.size();
  constexpr std::int64_t grain = 16384;
  const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
  std::vector<std::array<std::size_t, 2>> counts((triangles + grain - 1) / grain);  // faces, degenerate ones
  parallel_for(0, triangles, grain, [&](std::int64_t from, std::int64_t to) {
    auto& [faces, degenerate] = counts[from / grain];
    for (std::int64_t t = from; t < to; ++t) {
      faces += !repeats(mesh.triangles[t]);
      // The negation also counts an area that is not a number.
      degenerate += repeats(mesh.triangles[t]) || !(norm(triangle_normal(mesh, t)) / 2 >= 1e-12);
    }
  });
  std::size_t faces = 0;
  for (const auto& c : counts) {
    faces += c[0];
    r.degenerate_triangles += c[1];
  }
  const auto points = static_cast<std::int64_t>(mesh.points_mm.size());
  std::vector<Topology> parts((points + grain - 1) / grain);
  parallel_for(0, points, grain, [&](std::int64_t from, std::int64_t to) {
    parts[from / grain] = counts_at(mesh, incidence, static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(to));
  });
  for (const Topology& p : parts) {
    r.edges += p.edges;
    r.boundary_edges += p.boundary_edges;
    r.nonmanifold_edges += p.nonmanifold_edges;
    r.misoriented_edges += p.misoriented_edges;
    r.nonmanifold_points += p.nonmanifold_points;
    r.unused_points += p.unused_points;
    r.duplicate_triangles += p.duplicate_triangles;
  }
  r.components = count_components(mesh, incidence, r.nonmanifold_points == 0);
  r.euler_characteristic =
      static_cast<long>(r.points - r.unused_points) - static_cast<long>(r.edges) + static_cast<long>(faces);
  if (faces > 0 && r.closed() && r.manifold()) r.genus = r.components - r.euler_characteristic / 2;
  return r;
}

}  // namespace trephine::surface
