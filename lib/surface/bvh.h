// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A bounding volume hierarchy over a mesh's triangles for nearest-point queries.
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "surface/point_triangle.h"
#include "surface/trimesh.h"

namespace trephine::surface {

/// Four children a node, their boxes in float about the mesh's centre, side by side so that they are tested at once.
struct BvhNode {
  float lo[3][4], hi[3][4];
  std::uint32_t child[4];  ///< node, or the first entry of `order` where count > 0
  std::uint8_t count[4];   ///< triangles of a leaf; 0 is a node
  std::uint8_t children;
};

/// The boxes are split by the surface area heuristic over 16 bins [Wald2007]. The tree is the same whatever the thread
/// count. It refers to the mesh, which must outlive it, have at least one triangle and have coordinates below 1e15 mm.
class Bvh {
 public:
  explicit Bvh(const TriMesh& mesh, const Progress& progress = {});

  /// The triangle nearest to the point (in the mesh's own coordinates, about its origin). `seed` is a triangle that is
  /// likely near: it only saves time. Where a triangle within `enough_mm` has been met the search ends there. Boxes are
  /// compared in float with a margin, triangles in double: the distance is the least of all triangles' own.
  ClosestPoint nearest(Vec3 local, std::uint32_t seed, double enough_mm, std::uint32_t& triangle) const;

 private:
  ClosestPoint closest_on(Vec3 local, std::uint32_t triangle) const;
  const TriMesh& mesh_;
  Vec3 centre_;
  double radius_ = 0;  ///< of the box about centre_, by the largest coordinate
  std::vector<BvhNode> nodes_;
  std::vector<std::uint32_t> order_;
};

}  // namespace trephine::surface
