// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "surface/triangle_tree.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

/// How far a changing surface lies from one that stays; for the sources of this room only.
class DistanceToReference {
 public:
  /// The surfaces that are compared have their origin at `origin_mm`.
  DistanceToReference(const surface::TriMesh& reference, Vec3 origin_mm);
  DistanceToReference(const DistanceToReference&) = delete;  // the tree refers to the surface beside it
  DistanceToReference& operator=(const DistanceToReference&) = delete;

  /// The triangles of `mesh` that are not proven to lie within `bound_mm` of the reference, or near which the reference
  /// is not proven to lie within that of the mesh; ascending. Empty: the bound holds for every point of both.
  std::vector<std::uint32_t> beyond(const surface::TriMesh& mesh, double bound_mm, const Progress& progress) const;
  /// The largest distance, in either direction, of a point of one of the surfaces from the other.
  double largest_mm(const surface::TriMesh& mesh) const;

 private:
  surface::TriMesh reference_;
  surface::TriangleTree tree_;
};

}  // namespace trephine::meshing
