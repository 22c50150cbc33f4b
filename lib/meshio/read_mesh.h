// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/result.h"
#include "surface/trimesh.h"

namespace trephine::meshio {

struct ReadMeshLimits {
  std::uint64_t max_bytes = std::uint64_t{1} << 30;
  double max_s = 0;  ///< wall clock and CPU; 0: by the file's size (20 s and 1 s a MB of CPU)
};

struct ReadMeshResult {
  std::size_t triangles_count = 0, points_merged = 0, triangles_dropped = 0;
  bool closed = false;
  template <class V>
  static void describe(V& v) {
    using P = ReadMeshResult;
    v.integer(&P::triangles_count, "triangles_count", Range{}, "Triangles.");
    v.integer(&P::points_merged, "points_merged", Range{}, "Points that were merged with others.");
    v.integer(&P::triangles_dropped, "triangles_dropped", Range{}, "Triangles that lost a side by that.");
    v.flag(&P::closed, "closed", "Whether it is closed.");
  }
};

/// Reads a surface of any program as one mesh: .stl, .ply, .obj, .vtp, .vtk (legacy polygons) and .glb, by the
/// extension. Files of other programs are parsed in a bounded child (base/child.h) by assimp or VTK, so this process
/// survives whatever they hold. All meshes of the file are taken together, and polygons are cut into triangles (of .vtp
/// only triangles are taken, see vtp.h); colours, textures and materials are ignored. assimp reads float32.
///
/// Coordinates are taken as mm, LPS. Where the file's header says SPACE=RAS, as 3D Slicer writes it, x and y are
/// negated. A .glb is converted back from metres, Y up, to mm, LPS; one of ours says where it lies.
///
/// Points that coincide exactly are merged where the file's own indices leave the mesh open (STL has no indices, other
/// formats split points at seams and sharp edges). Triangles that lose a side by this are dropped, and points that no
/// triangle uses are removed. A mesh of ours (.vtp with its checksum, .glb) stays as it is. The result has passed
/// check_mesh and has at least one triangle, but need not be closed or valid: require_valid (meshing/validity.h) checks
/// that.
///
/// Throws Error naming the file: 66 where
/// it is missing; 64 for another extension; 65 where it is too large, damaged, has no triangle, or no reader survives
/// it within the limits.
Outcome<surface::TriMesh, ReadMeshResult> read_mesh_file(const std::filesystem::path& file,
                                                         const ReadMeshLimits& limits = {},
                                                         const Progress& progress = {});

}  // namespace trephine::meshio
