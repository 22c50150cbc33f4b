// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine {

/// Surfaces as files of other programs. World coordinates, DICOM patient LPS, mm, said in the file as 3D Slicer reads
/// it (SPACE=LPS) with UNIT=mm; the same bytes for the same surfaces. What a format holds:
///
///          coordinates                       colour                  opacity  normals   texture  surfaces
///   stl    float32, binary                   none                    no       facets'   no       one
///   ply    float32, binary little endian     uchar rgb a point       no       points'   yes      one
///   obj    text, exact doubles               Kd in the .mtl beside   yes      points'   yes      groups
///   vtp    doubles (see vtp.h)               uchar rgb a point       no       points'   yes      one
///   vtk    legacy 3.0, text, exact doubles   uchar rgb a point       no       points'   yes      one
///   wrl    VRML 2.0, text, exact doubles     diffuseColor            yes      points'   yes      shapes
///   x3d    3.3, XML, exact doubles           diffuseColor            yes      points'   yes      shapes
///   glb    float32 mm about the mesh's origin_mm, node matrix to metres and Y up (cases/glb.h); one, no texture
///
/// In world coordinates float32 holds 1/16384 mm up to 1,024 mm from the frame's origin and less beyond; text holds
/// every double.
enum class ExportFormat { stl, ply, obj, vtp, vtk, wrl, x3d, glb };

const std::vector<ExportFormat>& all_export_formats();
const char* name_of(ExportFormat format);  ///< "stl": what --format takes, and the extension without its dot
std::optional<ExportFormat> find_export_format(std::string_view name);
bool holds_several_surfaces(ExportFormat format);
bool holds_texture_coordinates(ExportFormat format);

struct ExportSurface {
  const TriMesh* mesh = nullptr;
  std::string name;                                 ///< [A-Za-z0-9_.-]{1,64}: of the group, shape or material
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};  ///< sRGB, 0 to 1
  double opacity = 1;
  /// Spherical texture coordinates about the surface's centroid and the z axis (meshio/texture.h), where the format has
  /// them. In ply, vtp, vtk and wrl, which take one texture point a vertex, vertices at the seam and the poles are
  /// doubled, so that the copy is no longer closed by its indices; in obj and x3d it is.
  bool texture_coordinates = false;
};

struct ExportFile {
  std::string name;  ///< "skull.obj", "skull.mtl"
  std::string bytes;
};

/// The files of one export, the main one last; obj has its .mtl before it. `stem` is their name without extension.
/// Normals are the mesh's, or area-weighted ones where it has none.
///
/// Throws Error, field the surface's name: 65 as check_mesh does; 80 where it has no triangles, or is not valid
/// (meshing/validity.h) in the coordinates as written, after rounding; 70 where the format takes one surface and
/// several were given, or a name, colour or opacity is out of range.
std::vector<ExportFile> encode_surfaces(ExportFormat format, const std::vector<ExportSurface>& surfaces,
                                        const std::string& stem, const Progress& progress = {});

/// What another program found in an export.
struct ExportCheck {
  std::string read_by;  ///< "assimp", "VTK"
  std::size_t triangles = 0;
  Bounds bounds_mm;
  double largest_difference_mm = 0;  ///< of a coordinate of a corner
};

/// Reads the files back with another program's reader (assimp; VTK's for vtp, vtk and wrl) in a bounded child and
/// compares with what they were made of: surfaces, their names where the reader gives them, triangles, every corner and
/// so the bounds, to float32's precision (stl, ply, vtp, vtk: to the last digit), colour and opacity where the format
/// has them, that texture coordinates are there.
///
/// Throws Error 80 with the file and what differs, also where the reader refuses the file; 70 where it dies.
ExportCheck verify_export(ExportFormat format, const std::vector<ExportSurface>& surfaces,
                          const std::vector<ExportFile>& files, const Progress& progress = {});

/// Writes all files, through FileWriter: every one is written whole before the first takes its name. Throws 73 and 74;
/// then nothing new is there (but for a rename that fails between two, which is said).
void write_export(const std::filesystem::path& folder, const std::vector<ExportFile>& files);

}  // namespace trephine
