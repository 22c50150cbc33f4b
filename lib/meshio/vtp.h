// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "surface/trimesh.h"

namespace trephine::meshio {

/// The file in which the single tools hand each other surfaces: VTK's XML PolyData (.vtp), as ParaView and 3D Slicer
/// read it, and a round trip of the mesh that is exact to the bit. Written appended, raw, without compression (every
/// reader of the format takes it; 1.5 million triangles in under a second), the same bytes for the same mesh.
///
///   Points                     world positions (origin_mm + points_mm), Float64, LPS, mm: what other programs see
///   PointData Normals          Float64, if the mesh has normals
///   PointData local_points_mm  points_mm, Float64; only where some point is not exactly (Points - origin_mm)
///   FieldData SPACE            "LPS", as 3D Slicer reads it
///   FieldData origin_mm        the mesh's origin_mm
///   behind the root element  a comment with the SHA-256 of every byte before it, so that damage is told as such
///
/// Throws 65 for a mesh that check_mesh refuses, 73 and 74 as write_file does, 70 where VTK fails.
void write_vtp(const std::filesystem::path& file, const surface::TriMesh& mesh);

/// Reads what write_vtp wrote, bit for bit, and what other programs write: float or double points and normals, any id
/// type, SPACE=RAS turned to LPS; without origin_mm the origin is 0. Only triangles are taken (no other polygons,
/// strips, lines, vertices), in one piece. The result has passed check_mesh.
///
/// Throws 66 where it is missing or unreadable; 65 naming the file where it is no PolyData, cut short, of another kind
/// than said above, damaged (checksum), has counts that its size cannot hold, indices out of range, or values that are
/// not finite. Every file is parsed in a bounded child (base/child.h), for VTK's reader can crash of one, and a
/// checksum that fits can be forged: 65 where the child is killed by it, 70 where it meets a limit. A foreign file
/// whose coordinates were altered within the finite numbers is not noticed.
surface::TriMesh read_vtp(const std::filesystem::path& file);

}  // namespace trephine::meshio
