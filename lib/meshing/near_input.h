// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "surface/incidence.h"
#include "surface/triangle_tree.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

/// Distances to a mesh from places that lie near one of its points, without a search from the top of a tree and with
/// little memory. Refers to the mesh.
class NearInput {
 public:
  explicit NearInput(const surface::TriMesh& mesh) : mesh_(mesh), incidence_(mesh) {}

  /// An upper bound of the squared distance to the surface. It examines the triangles around the point `near`; where
  /// the nearest place lies on their rim, it continues with the triangles around the rim's point, as long as that gets
  /// nearer and the bound is above `enough`. `near` becomes the point where it ended, and `triangle` the one to which
  /// the bound is the distance.
  double squared_bound(Vec3 place, std::uint32_t& near, double enough, std::uint32_t* triangle = nullptr) const {
    const Vec3 start = place - mesh_.points_mm[near];
    double best = dot(start, start);
    if (triangle) *triangle = incidence_.triangle[incidence_.begin[near]];
    for (std::uint32_t onward = near; onward != none && best > enough;) {
      near = onward;
      onward = none;
      const Vec3 a = mesh_.points_mm[near];
      for (std::uint32_t n = incidence_.begin[near]; n < incidence_.begin[near + 1]; ++n) {
        const auto& t = mesh_.triangles[incidence_.triangle[n]];
        const int k = t[0] == near ? 0 : t[1] == near ? 1 : 2;
        const std::uint32_t b = t[k == 2 ? 0 : k + 1], c = t[k == 0 ? 2 : k - 1];
        int across = 0;
        const double d2 = surface::squared_from_corner(place, a, mesh_.points_mm[b], mesh_.points_mm[c], across);
        if (d2 >= best) continue;
        best = d2;
        if (triangle) *triangle = incidence_.triangle[n];
        if (best <= enough) return best;
        onward = across == 0 ? none : across == 1 ? b : c;
      }
    }
    return best;
  }

  const surface::TriMesh& mesh() const { return mesh_; }
  const surface::Incidence& incidence() const { return incidence_; }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  const surface::TriMesh& mesh_;
  surface::Incidence incidence_;
};

}  // namespace trephine::meshing
