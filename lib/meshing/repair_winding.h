// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

/// The generalized winding number [Jacobson2013] of the triangles about a point, in the mesh's own coordinates: 1
/// within a closed surface oriented outwards, 0 outside, and in between where the surface has holes. Exact; the time is
/// linear in the number of triangles.
double winding_number(const surface::TriMesh& mesh, Vec3 local);

/// The generalized winding number within about 0.01, in logarithmic time: a group of triangles that is further away
/// than twice its size counts as a dipole ([Barill2018], first order). Refers to the mesh.
class WindingNumber {
 public:
  explicit WindingNumber(const surface::TriMesh& mesh);
  double at(Vec3 local) const;

 private:
  struct Node {
    Vec3 centre, area_normal;
    double radius = 0;
    std::uint32_t begin = 0, end = 0;   ///< indices into order_
    std::uint32_t left = 0, right = 0;  ///< 0: a leaf
  };
  std::uint32_t build(std::uint32_t begin, std::uint32_t end);
  const surface::TriMesh& mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<Vec3> middle_;
  std::vector<Node> nodes_;
};

/// A closed surface where the winding number is 1/2, on voxels_count voxels along the longest side of its bounds. It
/// lies within a voxel of the triangles where these have no holes. voxel_mm receives the voxel's side. Throws Error 80
/// where nothing is inside.
surface::TriMesh recontour(const surface::TriMesh& mesh, int voxels_count, double& voxel_mm,
                           const Progress& progress = {});

}  // namespace trephine::meshing
