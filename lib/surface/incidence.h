// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "surface/trimesh.h"

namespace trephine::surface {

/// For each point the triangles that use it, in ascending order, as one flat list. Indices must be in range. A triangle
/// with a repeated index is listed once for each corner.
struct Incidence {
  std::vector<std::uint32_t> begin;  ///< points + 1 offsets into `triangle`
  std::vector<std::uint32_t> triangle;

  explicit Incidence(const TriMesh& mesh);
};

/// The same as topology_of(mesh), for a mesh whose incidence is known already; parallel, with the same counts whatever
/// the thread count.
Topology topology_of(const TriMesh& mesh, const Incidence& incidence);

/// One use of an undirected edge by a triangle, seen from its lower point.
struct EdgeUse {
  std::uint32_t other;  ///< the higher point
  std::uint32_t triangle;
  bool forward;  ///< the triangle runs from the lower point to the higher
};

/// How many fans (groups of triangles joined by edges) meet in the point; 1 on a 2-manifold, 0 where no triangle uses
/// it.
int count_fans(const TriMesh& mesh, const Incidence& incidence, std::uint32_t point);

/// Calls visit(lower point, first use, past the last use) for each undirected edge, in ascending order of its points;
/// of those whose lower point is in [first, end). Triangles with a repeated index have no edges.
template <class Visit>
void for_each_edge(const TriMesh& mesh, const Incidence& incidence, std::uint32_t first, std::uint32_t end,
                   Visit&& visit) {
  std::vector<EdgeUse> uses;
  for (std::uint32_t p = first; p < end; ++p) {
    uses.clear();
    for (std::uint32_t n = incidence.begin[p]; n < incidence.begin[p + 1]; ++n) {
      const std::uint32_t t = incidence.triangle[n];
      const auto& v = mesh.triangles[t];
      if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
      const int corner = v[0] == p ? 0 : v[1] == p ? 1 : 2;
      const std::uint32_t next = v[(corner + 1) % 3], previous = v[(corner + 2) % 3];
      if (next > p) uses.push_back({next, t, true});
      if (previous > p) uses.push_back({previous, t, false});
    }
    for (std::size_t i = 1; i < uses.size() && uses.size() <= 64; ++i) {  // few, and no allocation
      const EdgeUse use = uses[i];
      std::size_t k = i;
      for (; k > 0 && uses[k - 1].other > use.other; --k) uses[k] = uses[k - 1];
      uses[k] = use;
    }
    if (uses.size() > 64)
      std::stable_sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) { return a.other < b.other; });
    for (auto from = uses.begin(); from != uses.end();) {
      auto to = from;
      while (to != uses.end() && to->other == from->other) ++to;
      visit(p, from, to);
      from = to;
    }
  }
}

template <class Visit>
void for_each_edge(const TriMesh& mesh, const Incidence& incidence, Visit&& visit) {
  for_each_edge(mesh, incidence, 0, static_cast<std::uint32_t>(mesh.points_mm.size()), visit);
}

/// The same as label_components and keep_large_components (trimesh.h), but several times as fast, for meshes in which
/// the triangles around each point are known to be joined by edges (one fan at each point).
int label_fan_components(const TriMesh& mesh, std::vector<int>& component_of_triangle);
int keep_large_fan_components(TriMesh& mesh, double min_volume_mm3);

}  // namespace trephine::surface
