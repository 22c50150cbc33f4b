// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.h"
#include "grid/grid.h"
#include "surface/fault_places.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

/// The properties that the program guarantees for every surface from contour to export.
struct Validity {
  surface::Topology topology;
  std::size_t self_intersections = 0;  ///< pairs of triangles that meet elsewhere than in their shared points and edges
  std::size_t degenerate = 0;          ///< triangles whose three points lie exactly on a line, or coincide
  std::size_t slivers = 0;             ///< smallest height below 1e-3 of the longest side; allowed, only counted
  double volume_mm3 = 0;
  surface::FaultPlaces places;  ///< the first 20 of each kind, world, LPS, mm
  bool float32 = false;         ///< every coordinate of points_mm is one that float32 holds
  bool valid() const {
    return topology.triangles > 0 && topology.closed() && topology.manifold() && self_intersections == 0 &&
           degenerate == 0 && volume_mm3 > 0;
  }
  /// Whether the two triangles of every edge run along it in opposite directions, and a closed surface is oriented
  /// outwards.
  bool oriented() const { return topology.misoriented_edges == 0 && (!topology.closed() || volume_mm3 > 0); }
  /// "closed, 2-manifold, no self-intersections", or what is wrong and where it is first, for an error's line.
  std::string text() const;
};

/// Checks a mesh. A mesh that it finds valid is proven_valid() from then on. It uses exact predicates on the double
/// coordinates and runs in parallel, with the same answer whatever the thread count. If the mesh's points are on
/// float32's raster (see snap_to_float32), the answer holds for the exported float32 mesh as well. Throws as check_mesh
/// does. `cells`: the lattice of whose cells marching cubes made the mesh; the answer is the same, and found sooner.
Validity check_validity(const surface::TriMesh& mesh, const Progress& progress = {},
                        const grid::Lattice* cells = nullptr);

/// The pairs of intersecting triangles (lower index first, ascending): they share no point and touch, or share points
/// and touch or overlap beyond them. Triangles in `only` (empty: all) are checked against all.
std::vector<std::array<std::uint32_t, 2>> self_intersections(const surface::TriMesh& mesh,
                                                             const Progress& progress = {},
                                                             const std::vector<std::uint32_t>& only = {});
std::vector<std::array<std::uint32_t, 2>> self_intersections(const surface::TriMesh& mesh,
                                                             const surface::Incidence& incidence,
                                                             const Progress& progress = {},
                                                             const std::vector<std::uint32_t>& only = {});
std::vector<std::array<std::uint32_t, 2>> self_intersections(const surface::TriMesh& mesh,
                                                             const surface::Incidence& incidence,
                                                             const grid::Lattice& cells, const Progress& progress = {});

/// The triangles whose three points lie exactly on a line, or coincide; ascending.
std::vector<std::uint32_t> degenerate_triangles(const surface::TriMesh& mesh);

/// Moves each point to the nearest multiple of a power of two of mm that float32 holds exactly: 2^-14 mm (0.06 um) for
/// a mesh that lies within 512 mm of its origin and is not tiny. Such points stay exact in float32 under every shift of
/// the origin by such multiples (whole mm, for instance) that leaves them within 1,024 mm. Every stage ends with this
/// step, so that the checked surface is the exported one. A mesh on the raster already keeps its proof.
void snap_to_float32(surface::TriMesh& mesh);
/// Where the origin lies outside the bounds, moves it to about their centre (in whole mm; finer for a tiny mesh); the
/// surface stays where it is, to the last digits.
void centre_origin(surface::TriMesh& mesh);
/// The step that snap_to_float32 uses for that mesh.
double float32_step_mm(const surface::TriMesh& mesh);

/// Throws Error 80 with the fault where the mesh is not valid. A mesh that is proven_valid() is not checked again, but
/// compared with what was proven: Error 70 where it was changed behind the proof's back (mesh_array.h).
void require_valid(const surface::TriMesh& mesh, const Progress& progress = {});

}  // namespace trephine::meshing
