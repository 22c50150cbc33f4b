// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine::meshio {

/// Surfaces as files of other programs. World coordinates, DICOM patient LPS, mm, said in the file as 3D Slicer reads
/// it (SPACE=LPS) with UNIT=mm, but for formats that say otherwise; the same bytes for the same surfaces. What each
/// format holds is declared with it.
struct ExportFormat;  // meshio/export_format.h

struct ExportSurface {
  const surface::TriMesh* mesh = nullptr;
  std::string name;                                 ///< [A-Za-z0-9_.-]{1,64}: of the group, shape or material
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};  ///< sRGB, 0 to 1
  double opacity = 1;
  /// Spherical texture coordinates about the surface's centroid and the z axis (meshio/texture.h), where the format has
  /// them. In ply, vtp, vtk and wrl, which take one texture point a vertex, vertices at the seam and the poles are
  /// doubled, so that the copy is no longer closed by its indices; in obj and x3d it is.
  bool texture_coordinates = false;
  bool to_look_at = false;  ///< as meshing::contour_to_look_at makes it: not looked through for self-intersections
};

struct ExportFile {
  std::string name;  ///< "skull.obj", "skull.mtl"
  std::string bytes;
};

/// Makes the files of one export, the main one last, after the others that belong to it. `stem` is their name without
/// extension. Normals are the mesh's, or area-weighted ones where it has none.
///
/// Throws Error with the surface's name as field: 65 as check_mesh does; 80 where it has no triangles, or is not valid
/// (meshing/validity.h) in the written coordinates, after rounding; 70 where the format takes one surface and several
/// were given, or a name, colour or opacity is out of range.
std::vector<ExportFile> encode_surfaces(const ExportFormat& format, const std::vector<ExportSurface>& surfaces,
                                        const std::string& stem, const Progress& progress = {});

/// What another program found in an export.
struct ExportCheck {
  std::string read_by;  ///< "assimp", "VTK"
  std::size_t triangles = 0;
  surface::Bounds bounds_mm;
  double largest_difference_mm = 0;  ///< largest difference of a coordinate of a corner
};

/// Reads the files back in a bounded child with another program's reader, which the format names, and compares the
/// result with the surfaces: their number, their names where the reader gives them, triangles, every corner and so the
/// bounds (to the precision of the reader's numbers), colour and opacity where the format has them, and whether texture
/// coordinates are there.
///
/// Throws Error 80 with the file and the difference, also where the reader refuses the file; 70 where it dies.
ExportCheck verify_export(const ExportFormat& format, const std::vector<ExportSurface>& surfaces,
                          const std::vector<ExportFile>& files, const Progress& progress = {});

/// Writes all files through FileWriter: every file is written completely before the first takes its name. Throws Error
/// 73 and 74; then no new file is there (unless a rename fails between two files, which is reported).
void write_export(const std::filesystem::path& folder, const std::vector<ExportFile>& files);

}  // namespace trephine::meshio
