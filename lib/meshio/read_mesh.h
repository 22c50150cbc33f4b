// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "surface/trimesh.h"

namespace trephine {

struct ReadMeshLimits {
  std::uint64_t max_bytes = std::uint64_t{1} << 30;
  double max_s = 0;  ///< wall clock and CPU; 0: by the file's size (20 s and 1 s a MB of CPU)
};

/// The extensions that read_mesh_file takes, with their dots.
const std::vector<std::string>& readable_mesh_extensions();

/// A surface from any program, as one mesh: .stl, .ply, .obj, .vtp, .vtk (legacy polygons) and .glb, by the extension.
/// Foreign bytes are parsed in a bounded child (base/child.h) by assimp or VTK: whatever they hold, this process
/// survives. All meshes of the file together; polygons cut into triangles (of .vtp only triangles are taken, see
/// vtp.h); colours, textures and materials are left. assimp reads float32.
///
/// Coordinates are taken for mm, LPS; where the file's header says SPACE=RAS, as 3D Slicer writes it, x and y are
/// turned. A .glb is taken back from metres, Y up, to mm, LPS; one of ours says where it lies.
///
/// Points that coincide exactly are merged where the file's own indices leave the mesh open (STL knows none, other
/// formats split points at seams and sharp edges); triangles that thereby lose a side are dropped; points that no
/// triangle uses go. A mesh of ours (.vtp with its checksum, .glb) stays as it is. The result has passed check_mesh and
/// has at least one triangle; that it is closed or valid is not promised: require_valid (meshing/validity.h) says.
///
/// Fills the report: triangles_count, points_merged, triangles_dropped, closed. Throws Error naming the file: 66 where
/// it is missing; 64 for another extension; 65 where it is too large, damaged, has no triangle, or no reader survives
/// it within the limits.
TriMesh read_mesh_file(const std::filesystem::path& file, Report& report, const ReadMeshLimits& limits = {},
                       const Progress& progress = {});

}  // namespace trephine
