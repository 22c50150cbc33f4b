// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "surface/triangle_tree.h"
#include "surface/trimesh.h"

namespace trephine::touch {

/// A mesh as algorithms of triangles feel it: with unit normals of its facets and a search tree. Points are those of
/// the mesh, about its origin. After the constructor nothing allocates or throws.
class FeltMesh {
 public:
  /// Throws Error 65 as check_mesh does, and where the mesh has no triangles.
  explicit FeltMesh(surface::TriMesh mesh);
  FeltMesh(const FeltMesh&) = delete;
  FeltMesh& operator=(const FeltMesh&) = delete;

  const surface::TriMesh& mesh() const { return mesh_; }
  const surface::TriangleTree& tree() const { return tree_; }
  Vec3 normal(std::uint32_t triangle) const { return normals_[triangle]; }  ///< zero where it has no area
  Vec3 corner(std::uint32_t triangle, int n) const {
    return mesh_.points_mm[mesh_.triangles[triangle][std::size_t(n)]];
  }
  /// How far the point is above the facet's plane.
  double above(std::uint32_t triangle, Vec3 p) const { return dot(normals_[triangle], p - corner(triangle, 0)); }
  /// Whether the point lies within the facet's three sides, seen along its normal.
  bool is_over(std::uint32_t triangle, Vec3 p) const;

  struct Crossing {
    std::uint32_t triangle = 0;
    double along = 2;  ///< on the segment, 0 to 1; above 1: none
    bool hit() const { return along <= 1; }
  };
  /// The first facet that the segment passes from its front to its back, without the `but` ones. A segment that begins
  /// on a facet's plane, to the last bit, begins in front of it; one that begins behind it does not meet it.
  Crossing first_crossing(Vec3 from, Vec3 to, const std::uint32_t* but = nullptr, int buts = 0) const;

  static surface::FloatBox box_around(Vec3 from, Vec3 to, double reach_mm) {
    surface::FloatBox box;
    const Vec3 reach{reach_mm, reach_mm, reach_mm};
    for (const Vec3 end : {from, to}) {
      box.add(end - reach);
      box.add(end + reach);
    }
    return box;
  }
  /// Calls look(triangle) for each facet whose box comes within `reach_mm` of the segment, piece by piece from its
  /// begin; where `along`, which look() may lower, lies in the pieces so far, the search ends.
  template <class Look>
  void look_along(Vec3 from, Vec3 to, double reach_mm, const double& along, const Look& look) const;

  /// The nearest point of the surface within `reach_mm`.
  struct Near {
    Vec3 point;
    std::uint32_t triangle = 0;
  };
  std::optional<Near> nearest(Vec3 p, double reach_mm) const;

 private:
  surface::TriMesh mesh_;
  std::vector<Vec3> normals_;
  surface::TriangleTree tree_;
  double piece_mm_ = 1;  // a segment is searched in pieces of this length, whose boxes hold few facets
};

template <class Look>
void FeltMesh::look_along(Vec3 from, Vec3 to, double reach_mm, const double& along, const Look& look) const {
  const Vec3 way = to - from;
  const int pieces = std::max(1, int(std::ceil(norm(way) / piece_mm_)));
  for (int piece = 0; piece < pieces; ++piece) {
    const surface::FloatBox box =
        box_around(from + way * (double(piece) / pieces),
                   piece + 1 < pieces ? from + way * (double(piece + 1) / pieces) : to, reach_mm);
    tree_.for_each_leaf(box, 0, [&](std::size_t leaf) {
      const std::size_t end = std::min(surface::TriangleTree::width * (leaf + 1), tree_.order().size());
      for (std::size_t n = surface::TriangleTree::width * leaf; n < end; ++n)
        if (tree_.box(n).meets(box)) look(tree_.order()[n]);
    });
    // What was found may lie in a later piece, where something else may be met before it.
    if (along <= double(piece + 1) / pieces) break;
  }
}

}  // namespace trephine::touch
