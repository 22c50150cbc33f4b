// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "meshing/triangle_tree.h"
#include "surface/incidence.h"
#include "surface/trimesh.h"

namespace trephine {

/// Distances to a mesh from places that lie near one of its points: no search from the top of a tree, and little
/// memory. Refers to the mesh.
class NearInput {
 public:
  explicit NearInput(const TriMesh& mesh) : mesh_(mesh), incidence_(mesh) {}

  /// Goes from the point `near` to its neighbours as long as that leads nearer, looks at the triangles there, and goes
  /// on around their corners as long as that leads nearer and the bound is above `enough`: an upper bound of the
  /// squared distance to the surface. `near` becomes the point where it ended.
  double squared_bound(Vec3 place, std::uint32_t& near, double enough) const {
    const auto squared = [&](std::uint32_t v) {
      const Vec3 d = place - mesh_.points_mm[v];
      return dot(d, d);
    };
    double best = squared(near);
    for (std::uint32_t centre = ~near; centre != near;) {
      centre = near;
      for (std::uint32_t n = incidence_.begin[centre]; n < incidence_.begin[centre + 1]; ++n) {
        const auto& t = mesh_.triangles[incidence_.triangle[n]];
        const std::uint32_t v = t[0] == centre ? t[1] : t[1] == centre ? t[2] : t[0];
        const double d2 = squared(v);
        if (d2 >= best) continue;
        best = d2;
        near = v;
      }
    }
    std::uint32_t triangle = ~0u;
    const auto look_around = [&](std::uint32_t v) {
      bool nearer = false;
      for (std::uint32_t n = incidence_.begin[v]; n < incidence_.begin[v + 1]; ++n) {
        const auto& t = mesh_.triangles[incidence_.triangle[n]];
        const Vec3 d =
            place - closest_on_triangle(place, mesh_.points_mm[t[0]], mesh_.points_mm[t[1]], mesh_.points_mm[t[2]]);
        if (dot(d, d) >= best) continue;
        best = dot(d, d);
        triangle = incidence_.triangle[n];
        nearer = true;
      }
      return nearer;
    };
    std::uint32_t centre = near;
    for (bool nearer = look_around(centre); nearer && best > enough;) {
      nearer = false;
      for (const std::uint32_t v : mesh_.triangles[triangle]) {
        if (v == centre || !look_around(v)) continue;
        centre = v;
        nearer = true;
        break;
      }
    }
    return best;
  }

  const TriMesh& mesh() const { return mesh_; }
  const Incidence& incidence() const { return incidence_; }

 private:
  const TriMesh& mesh_;
  Incidence incidence_;
};

}  // namespace trephine
