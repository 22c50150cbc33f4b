// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/vec3.h"
#include "surface/mesh_array.h"

namespace trephine::surface {

/// The plain indexed triangle mesh. Point i lies at origin_mm + points_mm[i] (DICOM patient LPS, mm). The local origin
/// keeps the doubles, and float32 on export, precise far from the frame's origin. Triangles are counter-clockwise seen
/// from outside.
///
/// A mesh carries the proof of its own validity. Only check_validity (meshing/validity.h) can give it, when it has
/// found the points and triangles valid; then proven_valid() is true for the mesh and its copies until a point or a
/// triangle can have changed (mesh_array.h says how that is known). Origin and normals do not matter for it. A step
/// that needs a valid mesh therefore asks the mesh, and no mesh is checked twice on its way from step to step.
struct TriMesh {
  Vec3 origin_mm;
  MeshArray<Vec3> points_mm;
  MeshArray<std::array<std::uint32_t, 3>> triangles;
  std::vector<Vec3> normals;  ///< empty, or one unit vector a point

  Vec3 world_mm(std::size_t i) const { return origin_mm + points_mm[i]; }
  bool proven_valid() const { return points_mm.proof() != 0 && points_mm.proof() == triangles.proof(); }
};

struct Bounds {
  Vec3 min_mm{1e300, 1e300, 1e300}, max_mm{-1e300, -1e300, -1e300};
};
/// World bounds of the points.
Bounds bounds_of(const TriMesh& mesh);

/// Checks what all our functions assume: finite points, indices in range, and normals that are empty or one for each
/// point. Throws Error 65 naming the first fault. Call it on meshes from outside.
void check_mesh(const TriMesh& mesh);

/// Combinatorial facts from the triangles alone, in O(n log n); only the degenerate count uses geometry.
struct Topology {
  std::size_t points = 0, triangles = 0, edges = 0;
  std::size_t boundary_edges = 0;      ///< used by one triangle
  std::size_t nonmanifold_edges = 0;   ///< used by three or more
  std::size_t misoriented_edges = 0;   ///< used twice in the same direction
  std::size_t nonmanifold_points = 0;  ///< whose triangles form more than one fan
  std::size_t unused_points = 0;
  std::size_t degenerate_triangles = 0;  ///< repeated index, or area below 1e-12 mm^2
  std::size_t duplicate_triangles = 0;
  int components = 0;
  long euler_characteristic = 0;  ///< V - E + F over used points
  /// Sum of the genera of the components; only where closed and manifold, else -1.
  long genus = -1;
  bool closed() const { return boundary_edges == 0; }
  bool manifold() const {
    return nonmanifold_edges == 0 && nonmanifold_points == 0 && duplicate_triangles == 0 && misoriented_edges == 0;
  }
};
Topology topology_of(const TriMesh& mesh);

double area_mm2(const TriMesh& mesh);
/// Signed volume; meaningful where closed and oriented, positive where the triangles look outwards.
double volume_mm3(const TriMesh& mesh);
Vec3 triangle_normal(const TriMesh& mesh, std::size_t triangle);  ///< not normalized: twice the area long

/// Removes points that no triangle uses, and keeps the order of the others. Where all are used, the mesh keeps its
/// proof.
void drop_unused_points(TriMesh& mesh);
/// For each triangle the number of its edge-connected component, 0 based in order of the first triangle; returns the
/// count.
int label_components(const TriMesh& mesh, std::vector<int>& component_of_triangle);
/// Keeps the edge-connected components with at least that many mm^3 of (absolute) volume, and always the largest.
/// Returns how many were removed.
int keep_large_components(TriMesh& mesh, double min_volume_mm3);

}  // namespace trephine::surface
