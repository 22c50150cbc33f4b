// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "surface/incidence.h"
#include "surface/trimesh.h"

namespace trephine::surface {

/// Where the faults of a surface are: for each kind the first `limit`, in the mesh's own order (edges and points by
/// their lowest point, triangles by their index, pairs by the lower triangle). World, LPS, mm.
struct FaultPlaces {
  static constexpr std::size_t limit = 20;
  std::vector<Vec3> open_edges;           ///< their midpoints
  std::vector<Vec3> nonmanifold_edges;    ///< their midpoints
  std::vector<Vec3> nonmanifold_points;   ///< where the surface meets itself
  std::vector<Vec3> misoriented_edges;    ///< their midpoints
  std::vector<Vec3> duplicate_triangles;  ///< centroids of the second and any further triangle
  std::vector<Vec3> degenerate;           ///< centroids
  std::vector<Vec3> slivers;              ///< centroids
  std::vector<Vec3> self_intersections;   ///< a point that both triangles hold, to the last digits
};

/// Appends the faults that follow from the triangles alone: open, non-manifold and misoriented edges, points,
/// duplicates. It walks over the whole mesh and is meant for meshes that are known to have faults.
void locate_topology_faults(const TriMesh& mesh, const Incidence& incidence, FaultPlaces& places);

/// Six times the signed volume of each piece (label_components), about a point of the piece. A change of its sign means
/// that the piece was turned inside out, which no other check finds, because its triangles need not meet.
std::vector<double> piece_volumes(const TriMesh& mesh, const std::vector<int>& piece_of, int pieces);

/// A point where two intersecting triangles (self_intersections) meet, beyond the point or edge that they share: the
/// midpoint of their common part where they cross, one of its corners where they overlap in a plane.
Vec3 place_of_intersection_mm(const TriMesh& mesh, std::uint32_t s, std::uint32_t t);

}  // namespace trephine::surface
