// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.h"
#include "meshing/fault_places.h"
#include "surface/trimesh.h"

namespace trephine {

/// What the program promises of every surface from contour to export.
struct Validity {
  Topology topology;
  std::size_t self_intersections = 0;  ///< pairs of triangles that meet elsewhere than in what they share
  std::size_t degenerate = 0;          ///< triangles whose three points lie exactly on a line, or coincide
  std::size_t slivers = 0;             ///< smallest height below 1e-3 of the longest side; allowed, only counted
  double volume_mm3 = 0;
  FaultPlaces places;    ///< the first 20 of each kind, world, LPS, mm
  bool float32 = false;  ///< every coordinate of points_mm is one that float32 holds
  bool valid() const {
    return topology.triangles > 0 && topology.closed() && topology.manifold() && self_intersections == 0 &&
           degenerate == 0 && volume_mm3 > 0;
  }
  /// Every edge's two triangles run along it in opposite directions, and what is closed looks outwards.
  bool oriented() const { return topology.misoriented_edges == 0 && (!topology.closed() || volume_mm3 > 0); }
  /// "closed, 2-manifold, no self-intersections" or what is wrong, and where first, for an error's line.
  std::string text() const;
};

/// A mesh that it finds valid is proven_valid() from then on. Exact predicates on the double coordinates; parallel, the
/// same answer whatever the thread count. Of a mesh whose points are on float32's raster (see snap_to_float32) it holds
/// for the exported float32 mesh as well. Throws as check_mesh does.
Validity check_validity(const TriMesh& mesh, const Progress& progress = {});

/// The pairs of triangles (lower index first, ascending) that intersect: they share no point and touch, or share points
/// and touch or overlap beyond them. Triangles in `only` (empty: all) against all.
std::vector<std::array<std::uint32_t, 2>> self_intersections(const TriMesh& mesh, const Progress& progress = {},
                                                             const std::vector<std::uint32_t>& only = {});
std::vector<std::array<std::uint32_t, 2>> self_intersections(const TriMesh& mesh, const Incidence& incidence,
                                                             const Progress& progress = {},
                                                             const std::vector<std::uint32_t>& only = {});

/// The triangles whose three points lie exactly on a line, or coincide; ascending.
std::vector<std::uint32_t> degenerate_triangles(const TriMesh& mesh);

/// Moves each point to the nearest multiple of a power of two of mm that float32 holds exactly: 2^-14 mm (0.06 um) for
/// what lies within 512 mm of its origin and is not tiny. Such points stay exact in float32 under every shift of the
/// origin by such multiples (whole mm, for instance) that leaves them within 1,024 mm. Every stage ends with it, so
/// that what was checked is what is exported. A mesh that is there already keeps its proof.
void snap_to_float32(TriMesh& mesh);
/// Moves the origin to about the centre of the bounds (whole mm; finer for a tiny mesh) where it lies outside them; the
/// surface stays where it is, to the last digits.
void centre_origin(TriMesh& mesh);
/// The step that snap_to_float32 uses for that mesh.
double float32_step_mm(const TriMesh& mesh);

/// Throws Error 80 with the fault where the mesh is not valid. One that is proven_valid() is not checked again.
void require_valid(const TriMesh& mesh, const Progress& progress = {});

}  // namespace trephine
