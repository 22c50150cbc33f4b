// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of meshio: the encoders behind meshio/export_mesh.h.
#include <array>
#include <string>
#include <vector>

#include "meshio/export_mesh.h"
#include "meshio/texture.h"

namespace trephine {

enum class Precision {
  float32_world,
  float32_local,  ///< about the mesh's origin_mm
  float64_world,
};
Precision precision_of(ExportFormat format);

/// A surface as a format holds it.
struct PreparedSurface {
  const ExportSurface* source = nullptr;
  std::vector<Vec3> world_mm;  ///< rounded to the precision
  std::vector<Vec3> normals;   ///< one a point
  TextureMap texture;          ///< empty where none is asked for or the format has none
  const TriMesh& mesh() const { return *source->mesh; }
  bool textured() const { return !texture.triangles.empty(); }
};

/// The mesh's points as the format's numbers hold them; a zero is +0.
std::vector<Vec3> rounded_world(const TriMesh& mesh, Precision precision);

/// The same with one vertex a texture point, for formats that know no second index; without texture a plain copy.
struct PlainSurface {
  std::vector<Vec3> world_mm, normals;
  std::vector<std::array<double, 2>> texture;  ///< empty, or one a point
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
PlainSurface plain_surface(const PreparedSurface& s);

std::array<unsigned char, 3> colour_bytes(const std::array<double, 3>& rgb);

std::string encode_stl(const PreparedSurface& s);
std::string encode_ply(const PreparedSurface& s);
std::string encode_legacy_vtk(const PreparedSurface& s);
std::string encode_obj(const std::vector<PreparedSurface>& all, const std::string& material_file);
std::string encode_mtl(const std::vector<PreparedSurface>& all);
std::string encode_vrml(const std::vector<PreparedSurface>& all);
std::string encode_x3d(const std::vector<PreparedSurface>& all);

}  // namespace trephine
